"""One QP over robot and things: a box held and pushed, two robots, in both forms, against the equation of motion."""

import numpy as np
import pinocchio as pin
import pytest

from solvers import Cascade, Weighted
from solvers.rows import Status
from sot.control import Contact, Controller, Stack
from sot.errors import InputError
from sot.robots import FLOOR, Robot, Surface, System, Thing
from tasks import CenterOfMass, JointBounds, LeastForces, OperationalPoint, Posture, TorqueBounds


@pytest.fixture(scope="module")
def robot():
    return Robot.load("hrp2")


def held_box(robot, mass=3.0):
    """A system with a box between the hands, which hang beside the body, and a stack that lifts it."""
    box = Thing.load("box", placement=(0.5, 0.0, 1.0), mass=mass)
    system = System(robot, [box])
    grips = [Contact(robot.surface(f"{s}_palm"), box.surface(s), least=10.0, stiffness=0.0) for s in ("left", "right")]
    stack = Stack(
        [*(Contact(robot.surface(foot)) for foot in robot.feet), *grips],
        [TorqueBounds(robot), JointBounds(robot)],
        {
            "com": [CenterOfMass(Controller(system, Stack([], [], {}), Cascade()).tick.com.copy(), axes="xy")],
            "box": [OperationalPoint(system, "box", [0.5, 0.0, 1.005], axes="z")],
            "posture": [Posture(robot, robot.rest[7:])],
            "forces": [LeastForces()],
        },
    )
    return system, stack


def residual_of_motion(controller, command):
    """M v̇ + h − Sᵀ τ − Jᵀ f of the whole system, from the wrenches that a command expects (nv,)."""
    tick, system = controller.tick, controller.system
    out = tick.M @ command.acceleration + tick.h
    out[system.driven] -= command.torque
    for contact, wrench in zip(controller.stack.contacts, command.wrenches, strict=True):
        out -= contact.motion(tick).jacobian.T @ wrench
    return out


@pytest.mark.parametrize("form", ["condensed", "full"])
def test_a_held_box_obeys_its_own_equation_of_motion(robot, form):
    system, stack = held_box(robot)
    controller = Controller(system, stack, Cascade(), form=form)
    command = controller(0.0, system.rest, np.zeros(system.nv))
    assert command.status == Status.SOLVED
    np.testing.assert_allclose(residual_of_motion(controller, command), 0.0, atol=1e-4)
    # The palms' forces carry it, and move it as the task asks: z̈ = 100 · 5 mm.
    box = system.velocities["box"]
    assert command.acceleration[box][2] == pytest.approx(0.5, abs=1e-6)
    lifting = -command.wrenches[2:, 2].sum()
    assert lifting == pytest.approx(3.0 * (9.81 + 0.5), abs=1e-3)
    for contact in stack.contacts:
        motion = contact.motion(controller.tick)
        relative = motion.jacobian @ command.acceleration + motion.drift
        np.testing.assert_allclose(relative, contact.acceleration(controller.tick), atol=1e-6)


def test_both_forms_agree(robot):
    torques = []
    for form in ("condensed", "full"):
        system, stack = held_box(robot)
        torques.append(Controller(system, stack, Cascade(), form=form)(0.0, system.rest, np.zeros(system.nv)).torque)
    np.testing.assert_allclose(*torques, atol=1e-3)


@pytest.mark.parametrize("solver", [Cascade, Weighted])
def test_a_thing_that_nothing_touches_falls_by_itself(robot, solver):
    system, stack = held_box(robot)
    for grip in stack.contacts[2:]:
        grip.mode = "off"
    stack.remove("box z")
    controller = Controller(system, stack, solver())
    command = controller(0.0, system.rest, np.zeros(system.nv))
    assert command.status == Status.SOLVED
    np.testing.assert_allclose(command.acceleration[system.velocities["box"]], [0, 0, -9.81, 0, 0, 0], atol=1e-6)
    alone = Stack(stack.contacts[:2], stack.hard, dict(stack.levels))
    expected = Controller(robot, alone, solver())(0.0, robot.rest, np.zeros(robot.nv))
    np.testing.assert_allclose(command.torque, expected.torque, atol=1e-3)


def test_two_robots_in_one_qp_push_each_other(robot):
    """The second one's torques are variables and limited too, Otani (20), (21); the force between them is one."""
    facing = pin.SE3(pin.utils.rotate("z", np.pi), np.array([1.0, 0.0, 0.0]))
    partner = Thing.of_robot(robot, "partner", facing)
    system = System(robot, [partner])
    feet = [Contact(one.surface(foot)) for one in (robot, partner) for foot in robot.feet]
    push = Contact(
        robot.surface("right_hand_end"), partner.surface("left_hand_end"), least=30.0, axes="xyz", stiffness=0.0
    )
    stack = Stack(
        [*feet, push],
        [TorqueBounds(system)],
        {"posture": [Posture(robot, robot.rest[7:])], "forces": [LeastForces()]},
    )
    controller = Controller(system, stack, Cascade())
    command = controller(0.0, system.rest, np.zeros(system.nv))
    assert command.status == Status.SOLVED and command.torque.shape == (2 * robot.na,)
    np.testing.assert_allclose(residual_of_motion(controller, command), 0.0, atol=1e-3)
    assert (np.abs(command.torque) <= system.effort + 1e-6).all()
    assert np.linalg.norm(command.wrenches[-1, :3]) > 29.0
    assert np.abs(command.torque[robot.na :]).max() > 1.0


PATCH = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0]]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda r: Contact(FLOOR, r.surface("left_foot")), "name the surface of the robot or thing first"),
        (lambda r: Contact(r.surface("left_palm"), r.surface("left_hand_end")), "both surfaces are of one body"),
        (lambda r: Contact(r.surface("left_foot"), axes="zz"), "axes 'zz'"),
        (lambda r: r.surface("left_paw"), "no surface 'left_paw'"),
        (lambda r: Surface.of_corners("flap", PATCH[:2]), "'flap': give three corners"),
        (lambda r: Surface.of_corners("flap", [*PATCH, [0.0, 0.1, 0.2]]), "'flap': its corners are not in one plane"),
        (lambda r: Thing.load("lamp"), "unknown thing 'lamp': choose one of bag, block, box"),
        (lambda r: Thing.load("box", mass=0.0), "mass = 0"),
        (lambda r: Thing.load("box", size=(1.0, 0.0, 1.0)), "size must be three sides"),
        (lambda r: Thing.load("door", size=(1.0, 1.0, 1.0)), "has no size"),
        (lambda r: Thing.load("box", placement=(1.0, 2.0)), "three numbers"),
    ],
)
def test_what_makes_no_sense_is_one_line(robot, make, message):
    with pytest.raises(InputError, match=message) as told:
        make(robot)
    assert "\n" not in str(told.value)


def test_a_thing_without_mass_is_refused(tmp_path):
    (tmp_path / "leaf.xml").write_text('<mujoco><worldbody><body name="leaf"><freejoint/></body></worldbody></mujoco>')
    (tmp_path / "leaf.toml").write_text('label = "Leaf"\nmodel = "leaf.xml"\n')
    with pytest.raises(InputError, match=r"leaf\.toml: a body of the thing moves and has no mass"):
        Thing.load(tmp_path / "leaf.toml")
