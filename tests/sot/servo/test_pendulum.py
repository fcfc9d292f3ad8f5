"""The pendulum with a compliant joint against its equations, against a body on a hinge in MuJoCo, in state space."""

import mujoco
import numpy as np
import pytest

from sot.gravity import GRAVITY
from sot.servo.pendulum import Pendulum

PENDULUM = Pendulum(mass=58.0, length=0.78, stiffness=4900.0, damping=49.0, inertia=7.0, led_inertia=5.0)
FREQUENCIES = np.geomspace(0.2, 10.0, 19)


def test_response_is_that_of_the_equation_of_motion():
    """A sine through an integration of m l² θ̈ + I δ̈ = m g l θ − K δ − b δ̇, from its own steady state."""
    p, frequency, size = PENDULUM, 1.1, 0.01
    omega, h = 2.0 * np.pi * frequency, 1e-4
    y = p.response(np.array([frequency]))[0] * size
    # δ follows from y = (K + b s) δ / (m g); begin there.
    start = y * p.weight / (p.stiffness + p.damping * 1j * omega)
    delta, rate = start.imag, (1j * omega * start).imag
    worst = 0.0
    for k in range(20000):
        t = k * h
        zmp = (p.stiffness * delta + p.damping * rate) / p.weight
        worst = max(worst, abs(zmp - (y * np.exp(1j * omega * t)).imag))

        def accelerate(t: float, delta: float, rate: float) -> float:
            u, du2 = size * np.sin(omega * t), -(omega**2) * size * np.sin(omega * t)
            moment = p.weight * p.length * (u + delta) - p.stiffness * delta - p.damping * rate
            return (moment - p.leading_inertia * du2) / p.turning_inertia

        middle = accelerate(t + 0.5 * h, delta + 0.5 * h * rate, rate + 0.5 * h * accelerate(t, delta, rate))
        delta, rate = delta + h * rate + 0.5 * h**2 * middle, rate + h * middle
    assert worst < 0.005 * abs(y)


def test_linearisation_is_that_of_a_body_on_a_hinge_in_mujoco():
    """A hinge with spring and damper, a slide above it that moves the body: finite differences of its acceleration."""
    p = PENDULUM
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco><option gravity="0 0 -{GRAVITY}"/><worldbody><body>
        <joint type="hinge" axis="0 1 0" stiffness="{p.stiffness}" damping="{p.damping}"/>
        <inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>
        <body pos="0 0 {p.length}"><joint type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="{p.mass}" diaginertia="{p.inertia} {p.inertia} {p.inertia}"/></body>
        </body></worldbody></mujoco>""")
    data = mujoco.MjData(model)

    def hinge_acceleration(delta: float, rate: float, shift: float, push: float) -> float:
        """δ̈ for a slide that is held at a shift and accelerated: inverse dynamics of the hinge's row."""
        data.qpos[:], data.qvel[:] = (delta, shift), (rate, 0.0)
        moments = []
        for acceleration in (0.0, 1.0):
            data.qacc[:] = acceleration, push
            mujoco.mj_inverse(model, data)
            moments.append(data.qfrc_inverse[0])
        return -moments[0] / (moments[1] - moments[0])

    h, found = 1e-5, []
    for direction in np.eye(4):
        found.append((hinge_acceleration(*(h * direction)) - hinge_acceleration(*(-h * direction))) / (2.0 * h))
    excess = p.weight * p.length - p.stiffness
    expected = np.array([excess, -p.damping, p.weight, -p.mass * p.length]) / p.turning_inertia  # I_u = 0
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize("lag, delay", [(0.0, 0.0), (0.004, 0.0), (0.004, 0.01)])
def test_filtered_states_respond_like_the_pendulum_behind_a_filter(lag, delay):
    pendulum = Pendulum(58.0, 0.78, 4900.0, 49.0, 7.0, 5.0, lag, delay)
    filter_time = 0.2
    system = pendulum.filtered_states(filter_time)
    wanted = pendulum.response(FREQUENCIES) / (1.0 + 2j * np.pi * FREQUENCIES * filter_time)
    # Padé's phase is (ω T)³ / 12 off.
    tolerance = 1e-9 + (2.0 * np.pi * FREQUENCIES * delay) ** 3 / 12.0
    assert np.all(
        np.abs(system._replace(B=system.B[:, :1], D=system.D[:, :1]).response(FREQUENCIES) / wanted - 1.0) < tolerance
    )


def test_printed_states_are_the_pendulum_without_inertia_and_damping():
    pendulum = Pendulum(58.0, 0.78, 4900.0, 0.0)
    system = pendulum.printed_states()
    response = system._replace(B=system.B[:, :1], D=system.D[:, :1]).response(FREQUENCIES)
    np.testing.assert_allclose(response, pendulum.response(FREQUENCIES), rtol=1e-9)


def test_a_disturbing_moment_moves_the_zero_moment_point_by_what_the_joint_takes_up():
    system = PENDULUM.filtered_states(0.2)
    static = (system.D - system.C @ np.linalg.solve(system.A, system.B))[0, 1]
    excess = PENDULUM.stiffness - PENDULUM.weight * PENDULUM.length
    assert static == pytest.approx(PENDULUM.stiffness / PENDULUM.weight / excess)


def test_gains_frequency_and_damping_ratio_are_those_of_the_response():
    static, fast = np.abs(Pendulum(58.0, 0.78, 4900.0, 0.0, 7.0, 5.0).response(np.array([1e-4, 1e3])))
    assert static == pytest.approx(PENDULUM.static_gain, rel=1e-4)
    assert fast == pytest.approx(PENDULUM.high_frequency_gain, rel=1e-4)
    poles = np.linalg.eigvals(PENDULUM.filtered_states(0.2).A)
    pole = poles[np.argmax(poles.imag)]
    assert abs(pole) == pytest.approx(PENDULUM.natural_frequency)
    assert -pole.real / abs(pole) == pytest.approx(PENDULUM.damping_ratio)


def test_a_joint_softer_than_m_g_l_has_no_natural_frequency():
    assert np.isnan(Pendulum(58.0, 0.78, 400.0, 4.0).natural_frequency)
