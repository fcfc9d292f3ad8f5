import numpy as np
import pinocchio as pin
import pytest

from sot.errors import InputError
from sot.motion.body.coordinates import from_configuration
from sot.motion.body.spline import Spline
from sot.motion.feet.contacts import planted_phases, support_polygon
from sot.motion.plan import sampled_motion
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import Surface

RATE = 200.0


@pytest.fixture(scope="module")
def motion():
    robot = Robot.load("hrp2")
    t = 0.02 * np.arange(100)
    window = np.sin(np.pi * t / t[-1])[:, None] ** 4
    y = from_configuration(robot.rest[None]) + 0.2 * np.sin(np.outer(t, np.linspace(2.0, 6.0, robot.nv))) * window
    control = Spline.through(y, 0.02).control
    control[:3], control[-3:] = y[0], y[-1]
    return sampled_motion(robot, Spline(control, 0.02), planted_phases(robot, t[-1]), RATE)


def test_velocity_and_acceleration_are_derivatives(motion):
    model, dt = motion.robot.model, 1.0 / RATE
    for k in range(5, len(motion.q) - 5, 11):
        difference = pin.difference(model, motion.q[k - 1], motion.q[k + 1]) / (2 * dt)
        np.testing.assert_allclose(motion.v[k], difference, atol=2e-3)
        np.testing.assert_allclose(motion.a[k], (motion.v[k + 1] - motion.v[k - 1]) / (2 * dt), atol=0.15)


def test_a_motion_elsewhere_is_the_same_motion(motion):
    """CoM and its rates from the moved configurations, and the feet where they carry it."""
    moved = motion.placed(100.0, -30.0, np.deg2rad(137.0))
    model, data = motion.robot.model, motion.robot.model.createData()
    place = pin.SE3(pin.exp3(np.array([0.0, 0.0, np.deg2rad(137.0)])), np.array([100.0, -30.0, 0.0]))
    for k in range(0, len(motion.q), 37):
        pin.centerOfMass(model, data, moved.q[k], moved.v[k], moved.a[k])
        np.testing.assert_allclose(moved.com[k], data.com[0])
        np.testing.assert_allclose(moved.com_velocity[k], data.vcom[0], atol=1e-12)
        np.testing.assert_allclose(moved.com_acceleration[k], data.acom[0], atol=1e-9)
        np.testing.assert_allclose(moved.momentum[k], place.rotation @ motion.momentum[k], atol=1e-12)
        np.testing.assert_allclose([*moved.zmp[k], 0.0], place.act(np.append(motion.zmp[k], 0.0)))
        pin.framesForwardKinematics(model, data, moved.q[k])
        waist = data.oMf[motion.robot.point("waist")].homogeneous
        pin.framesForwardKinematics(model, data, motion.q[k])
        expected = (place * data.oMf[motion.robot.point("waist")]).homogeneous
        np.testing.assert_allclose(waist, expected, atol=1e-9)
    for foot, at in motion.phases[0].feet.items():
        np.testing.assert_allclose(moved.phases[0].feet[foot].homogeneous, (place * at).homogeneous)


def test_centre_of_mass(motion):
    for k in range(0, len(motion.q), 37):
        data = motion.robot.model.createData()
        pin.centerOfMass(motion.robot.model, data, motion.q[k], motion.v[k], motion.a[k])
        np.testing.assert_allclose(motion.com[k], data.com[0])
        np.testing.assert_allclose(motion.com_velocity[k], data.vcom[0], atol=1e-12)
        np.testing.assert_allclose(motion.com_acceleration[k], data.acom[0], atol=1e-10)


def test_sample_between_and_beyond(motion):
    k = 50
    for name, value in motion.sample(motion.times[k])._asdict().items():
        np.testing.assert_allclose(value, getattr(motion, name)[k])
        between = getattr(motion.sample(motion.times[k] + 0.25 / RATE), name)
        np.testing.assert_allclose(between, 0.75 * getattr(motion, name)[k] + 0.25 * getattr(motion, name)[k + 1])
    for t, end in ((-1.0, 0), (motion.duration + 1.0, -1)):
        outside = motion.sample(t)
        np.testing.assert_array_equal(outside.q, motion.q[end])
        np.testing.assert_allclose(outside.v, 0.0, atol=1e-9)
        np.testing.assert_allclose(outside.a, 0.0, atol=1e-7)


@pytest.mark.parametrize("point", ["left_hand", "head", "right_foot"])
def test_track_of_a_point(motion, point):
    track, dt = motion.track(point), 1.0 / RATE
    assert motion.track(point) is track
    speed = (track.position[2:] - track.position[:-2]) / (2 * dt)
    np.testing.assert_allclose(track.velocity[1:-1, :3], speed, atol=5e-3)
    spin = [
        pin.log3(after @ before.T) / (2 * dt)
        for before, after in zip(track.rotation[:-2], track.rotation[2:], strict=True)
    ]
    np.testing.assert_allclose(track.velocity[1:-1, 3:], spin, atol=5e-3)
    change = (track.velocity[2:] - track.velocity[:-2]) / (2 * dt)
    np.testing.assert_allclose(track.acceleration[1:-1], change, atol=0.3)


def test_unknown_point(motion):
    with pytest.raises(InputError, match="no point 'tail'"):
        motion.track("tail")


def test_save_and_load(motion, tmp_path):
    path = tmp_path / "motion.npz"
    motion.save(path)
    loaded = Motion.load(path)
    assert loaded.robot is motion.robot and loaded.rate == motion.rate
    for name in ("q", "v", "a", "com", "com_velocity", "com_acceleration", "zmp", "momentum"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(motion, name))
    assert (loaded.phases[0].start, loaded.phases[0].end) == (motion.phases[0].start, motion.phases[0].end)
    for foot, pose in motion.phases[0].feet.items():
        assert loaded.phases[0].feet[foot].isApprox(pose)


def test_load_refuses_what_is_no_motion(motion, tmp_path):
    path = tmp_path / "motion.npz"
    with pytest.raises(InputError, match="cannot be read"):
        Motion.load(path)
    path.write_bytes(b"not a zip")
    with pytest.raises(InputError, match="cannot be read"):
        Motion.load(path)
    np.savez(path, q=motion.q)
    with pytest.raises(InputError, match="lacks a, com"):
        Motion.load(path)
    motion.save(path)
    with pytest.raises(InputError, match="joints are not those"):
        Motion.load(path, Robot.load("hrp2_modified"))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("v", np.zeros((3, 36)), "'v' has shape"),
        ("zmp", "nan", "not a finite number"),
        ("rate", np.float64(-1.0), "positive rate"),
        ("phase_times", np.zeros((0, 2)), "contact phases"),
    ],
)
def test_load_refuses_damaged_columns(motion, tmp_path, name, value, message):
    path = tmp_path / "motion.npz"
    motion.save(path)
    content = dict(np.load(path))
    content[name] = np.full_like(content[name], np.nan) if isinstance(value, str) else value
    np.savez(path, **content)
    with pytest.raises(InputError, match=message):
        Motion.load(path)


def test_standing_is_at_rest_with_its_centre_of_mass_over_its_feet():
    robot = Robot.load("hrp2")
    motion = Motion.standing(robot, 0.5, 200.0)
    assert (len(motion.q), motion.duration, motion.phases[0].end) == (101, 0.5, 0.5)
    np.testing.assert_array_equal(motion.q, np.tile(robot.rest, (101, 1)))
    com = pin.centerOfMass(robot.model, robot.model.createData(), robot.rest)
    np.testing.assert_allclose(motion.com, np.tile(com, (101, 1)))
    assert support_polygon(robot, motion.phases[0]).margin(motion.zmp[:1])[0] > 0.05
    for foot in robot.feet:
        np.testing.assert_allclose(motion.feet[foot](0.2), motion.pose(foot)(0.2).position)


@pytest.mark.parametrize(("seconds", "rate"), [(0.0, 100.0), (-1.0, 100.0), (1.0, 0.0), (1e-4, 100.0)])
def test_standing_needs_some_time(seconds, rate):
    with pytest.raises(InputError, match="has no two samples"):
        Motion.standing(Robot.load("hrp2"), seconds, rate)


def test_a_motion_on_a_block_is_neither_saved_without_the_block_nor_moved_away_from_it(tmp_path):
    robot = Robot.load("hrp2")
    corners = [(-0.5, -0.5, 0.1), (0.5, -0.5, 0.1), (0.5, 0.5, 0.1), (-0.5, 0.5, 0.1)]
    block = Surface.of_corners("block", corners)
    motion = Motion.standing(robot, 0.5, 200.0, on=dict.fromkeys(robot.feet, block))
    with pytest.raises(InputError, match=r"a motion of feet on block cannot be saved: only one on the floor can"):
        motion.save(tmp_path / "motion.npz")
    assert not list(tmp_path.iterdir())
    with pytest.raises(InputError, match=r"cannot be placed elsewhere"):
        motion.placed(1.0, 0.0, 0.0)
