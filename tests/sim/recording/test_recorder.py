"""The recording holds what the run held, in few columns."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import Chunk, RrdReader

from sim.log import FOOT_OFF, RunInfo, RunLog
from sim.push import Push
from sim.recording.bodies import body_poses
from sim.recording.panels import FRAME_RATE, divergent_component, measured_and_planned_dcm
from sim.recording.recorder import write_recording
from sim.recording.shapes import read_scenery, read_shapes
from sot.motion.plan import PLAN_RATE, Plan
from sot.robots.robot import Robot, shipped_robot_names
from tests.sim.runs import PERIOD, perfect_log, same_plan, still_motion

PUSH = Push(t=1.0, force=(80.0, 0.0, 0.0), duration=0.2)
INFO = RunInfo(clip="made-up", robot="hrp2", solver="cascade", feet="planted", rate_hz=1.0 / PERIOD, pushes=(PUSH,))
SECONDS = 2.0
ROBOT = Robot.load("hrp2")


@pytest.fixture(scope="module")
def log() -> RunLog:
    log = perfect_log(still_motion(ROBOT, SECONDS))
    knee = 7 + ROBOT.joints.index("LLEG3")
    log.q[: log.ticks, knee] += np.linspace(0.0, 0.5, log.ticks)
    log.zmp_measured[:50] = np.nan
    log.foot_mode[100:200, 0] = FOOT_OFF
    return log


def slowed(plan: Plan) -> Plan:
    """The clip at half its speed from the middle on."""
    steps = np.where(np.arange(60) < 30, 1.0, 2.0) / PLAN_RATE
    return replace(plan, clock=np.concatenate([[0.0], np.cumsum(steps)]))


@pytest.fixture(scope="module")
def chunks(log: RunLog, tmp_path_factory: pytest.TempPathFactory) -> list[Chunk]:
    folder = tmp_path_factory.mktemp("run")
    motion = still_motion(ROBOT, SECONDS)
    write_recording(folder / "run.rrd", log, INFO, motion, slowed(same_plan(motion)))
    assert [path.name for path in folder.iterdir()] == ["run.rrd"]
    return RrdReader(folder / "run.rrd").stream().to_chunks()


def column(chunks: list[Chunk], entity: str, component: str) -> tuple[np.ndarray, pa.Array]:
    """Times [s] and values of a component that changes."""
    (chunk,) = [chunk for chunk in chunks if chunk.entity_path == entity and not chunk.is_static]
    batch = chunk.to_record_batch()
    (name,) = [name for name in batch.schema.names if name.endswith(component)]
    return batch.column("time").cast(pa.int64()).to_numpy() * 1e-9, batch.column(name)


def test_curves_keep_the_control_rate(chunks, log):
    times, values = column(chunks, "/joints/left_leg/angle/joints", "Scalars:scalars")
    np.testing.assert_allclose(times, log.time[: log.ticks], atol=1e-9)
    angles = np.array(values.to_pylist())
    joints = list(ROBOT.groups["left_leg"])
    np.testing.assert_allclose(angles, np.rad2deg(log.q[: log.ticks, 7:][:, joints]), atol=1e-4)


def shape_centers(chunks: list[Chunk], entity: str, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (T,) and places (T, 3) of the first cylinder on a body."""
    times, values = column(chunks, entity, "Cylinders3D:centers")
    cylinders = [shape.body for shape in read_shapes(ROBOT) if shape.kind == "cylinder"]
    return times, np.array(values.to_pylist())[:, cylinders.index(body)]


def test_bodies_move_at_the_frame_rate(chunks, log):
    times, places = shape_centers(chunks, "/world/robot", "LLEG4_LINK")
    assert len(times) == pytest.approx(SECONDS * FRAME_RATE, abs=1)
    shape = next(s for s in read_shapes(ROBOT) if (s.body, s.kind) == ("LLEG4_LINK", "cylinder"))
    position, rotation = body_poses(ROBOT, ["LLEG4_LINK"], log.q[log.rows_at(FRAME_RATE)][-1:])
    np.testing.assert_allclose(places[-1], position[0, 0] + rotation[0, 0] @ shape.position, atol=1e-6)
    assert np.linalg.norm(places[-1] - places[0]) > 0.1
    _, still = shape_centers(chunks, "/world/reference", "LLEG4_LINK")
    np.testing.assert_allclose(still, still[:1].repeat(len(still), axis=0), atol=1e-6)


def test_what_was_not_measured_is_not_shown(chunks):
    _, values = column(chunks, "/world/balance/zmp_measured", "Points3D:positions")
    shown = np.array([bool(row) for row in values.to_pylist()])
    assert not shown[: round(50 * PERIOD * FRAME_RATE) - 1].any()
    assert shown[round(50 * PERIOD * FRAME_RATE) + 1 :].all()


def test_a_contact_changes_its_state_and_its_sole_the_colour(chunks, log):
    times, states = column(chunks, "/contacts/left_foot", "StateChange:state")
    assert states.to_pylist() == [["fixed"], ["off"], ["fixed"]]
    np.testing.assert_allclose(times, log.time[[0, 100, 200]], atol=1e-9)
    times, colors = column(chunks, "/world/contact/left_foot/sole", "LineStrips3D:colors")
    shown = np.array(colors.to_pylist())[:, 0]
    off = (times >= log.time[100]) & (times < log.time[200])
    assert len(set(shown[off])) == len(set(shown[~off])) == 1
    assert shown[off][0] != shown[~off][0]


def test_a_push_is_shown_while_it_acts(chunks):
    times, arrows = column(chunks, "/world/push/0", "Arrows3D:vectors")
    shown = np.array([bool(row) for row in arrows.to_pylist()])
    assert PUSH.t <= times[0]
    assert shown[:-1].all()
    assert not shown[-1]
    assert times[-1] == pytest.approx(PUSH.end)


def test_measured_and_planned_divergent_components_agree_in_a_perfect_run():
    motion = still_motion(ROBOT, SECONDS)
    measured, planned = measured_and_planned_dcm(perfect_log(motion).trimmed(), motion)
    np.testing.assert_allclose(measured, planned, atol=1e-9)
    np.testing.assert_allclose(planned, motion.com[:-1, :2], atol=1e-9)


def test_the_divergent_component_runs_away_at_the_rate_of_the_pendulum():
    com, velocity, height, step = np.array([[0.1, 0.0, 0.8]]), np.array([[0.2, -0.1, 0.0]]), np.array([0.8]), 1e-6
    omega = np.sqrt(9.81 / 0.8)
    faster = velocity + step * omega**2 * com * [1.0, 1.0, 0.0]  # the ZMP at the origin
    before, after = (
        divergent_component(com, velocity, height),
        divergent_component(com + step * velocity, faster, height),
    )
    np.testing.assert_allclose((after - before) / step, omega * before, rtol=1e-4)


def test_where_time_was_stretched(chunks):
    times, values = column(chunks, "/time/speed/share", "Scalars:scalars")
    share = np.array(values.to_pylist())[:, 0]
    np.testing.assert_allclose(share, np.where(times < 30 / PLAN_RATE, 100.0, 50.0), rtol=1e-6)


def test_what_holds_throughout_comes_first_and_the_robot_before_the_curves(chunks):
    static = [chunk.is_static for chunk in chunks]
    assert static == sorted(static, reverse=True)
    moving = [chunk.entity_path for chunk in chunks if not chunk.is_static]
    assert moving.index("/world/robot") == 0
    assert max(k for k, entity in enumerate(moving) if entity.startswith("/world")) < min(
        k for k, entity in enumerate(moving) if not entity.startswith("/world")
    )


def test_everything_a_user_wants_to_see_is_there(chunks):
    entities = {chunk.entity_path for chunk in chunks}
    limbs = [f"/joints/{limb}" for limb in ("left_leg", "right_leg", "trunk", "left_arm", "right_arm")]
    parts = ("angle/joints", "range/joints", "error/joints", "torque/joints", "torque/limits")
    balance = ("com", "zmp_measured", "zmp_controller", "zmp_planned", "dcm_measured", "dcm_planned")
    assert entities >= {
        *("/world/human/bones", "/world/contact/left_foot", "/world/contact/support"),
        *("/world/plan/footholds", "/world/plan/com", *(f"/world/balance/{name}" for name in balance)),
        *("/balance/x/zmp", "/balance/y/support", "/balance/force/load", "/com/x/way", "/com/divergent/dcm_error"),
        *(f"{limb}/{part}" for limb in limbs for part in parts),
        *("/tasks/balance\\:\\ com/error", "/tasks/posture\\:\\ joints/error"),
        *("/tick/time/time", "/tick/status/status", "/about"),
    }


def test_a_fallen_run_without_a_human_is_recorded_too(tmp_path: Path):
    motion = still_motion(ROBOT, SECONDS)
    log = perfect_log(motion)
    log.ticks = 3
    fallen = RunInfo("made-up", "hrp2", "cascade", "planted", 200.0, fell_at_s=0.01, reason="the waist sank")
    write_recording(tmp_path / "run.rrd", log, fallen, motion, None)
    entities = {chunk.entity_path for chunk in RrdReader(tmp_path / "run.rrd").stream().to_chunks()}
    assert "/world/robot" in entities
    assert not any(entity.startswith("/world/human") for entity in entities)


@pytest.mark.parametrize("name", shipped_robot_names())
def test_shapes_belong_to_bodies_that_pinocchio_knows(name):
    robot = Robot.load(name)
    shapes = read_shapes(robot)
    bodies = sorted({shape.body for shape in shapes})
    assert all(robot.model.existBodyName(body) for body in bodies)
    assert {shape.kind for shape in shapes} == {"box", "capsule", "cylinder", "ellipsoid"}
    positions, rotations = body_poses(robot, bodies, robot.rest[None])
    lows = []
    for shape in shapes:
        index = bodies.index(shape.body)
        center = positions[index, 0] + rotations[index, 0] @ shape.position
        lows.append(center[2])
    assert 0.0 < min(lows) < 0.1
    assert 1.3 < max(lows) < 1.6


@pytest.mark.parametrize(("rate", "count"), [(60.0, 120), (1000.0, 400), (200.0, 400)])
def test_rows_at_a_lower_rate(log, rate, count):
    rows = log.rows_at(rate)
    assert len(rows) == pytest.approx(count, abs=1)
    assert (np.diff(rows) > 0).all()
    assert rows[0] == 0
    assert rows[-1] < log.ticks


def test_a_scene_is_shown_where_it_is(log, tmp_path):
    scene = """<mujoco><worldbody>
      <geom type="box" size="0.2 0.4 0.02" pos="0.6 0 0.5"/>
      <body pos="1 0 0"><geom type="capsule" size="0.1 0.3" pos="0 0.5 0.4" zaxis="1 0 0"/></body>
      <body pos="0 0 2"><freejoint/><geom size="0.1"/></body>
    </worldbody></mujoco>"""
    box, capsule = read_scenery(ROBOT, scene)
    np.testing.assert_allclose(box.position, [0.6, 0.0, 0.5])
    np.testing.assert_allclose(capsule.position, [1.0, 0.5, 0.4])
    np.testing.assert_allclose(capsule.half_sizes, [0.1, 0.1, 0.3])
    motion = still_motion(ROBOT, SECONDS)
    write_recording(tmp_path / "run.rrd", log, INFO, motion, None, scene)
    chunks = RrdReader(tmp_path / "run.rrd").stream().to_chunks()
    _, centers = column(chunks, "/world/scene/box", "centers")
    np.testing.assert_allclose(np.array(centers.to_pylist()).ravel(), [0.6, 0.0, 0.5])
    # Rerun's capsule starts at one end, 0.3 m from its middle along its axis.
    _, starts = column(chunks, "/world/scene/capsule", "translations")
    np.testing.assert_allclose(np.array(starts.to_pylist()).ravel(), [0.7, 0.5, 0.4], atol=1e-6)
