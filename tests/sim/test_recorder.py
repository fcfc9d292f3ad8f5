"""The recording holds what the run held, in few columns."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from rerun.chunk import Chunk, RrdReader

from sim.log import RunInfo, RunLog
from sim.recorder import record
from sim.shapes import read_shapes
from sim.visuals import FRAME_RATE, body_poses
from sot.errors import InputError
from sot.robot import Robot, robots

from .runs import PERIOD, perfect_log, same_human, still_motion

INFO = RunInfo(clip="made-up", robot="hrp2", solver="cascade", feet="planted", rate_hz=1.0 / PERIOD)
SECONDS = 2.0
ROBOT = Robot.load("hrp2")


@pytest.fixture(scope="module")
def log() -> RunLog:
    log = perfect_log(still_motion(ROBOT, SECONDS))
    knee = 7 + ROBOT.joints.index("LLEG3")
    log.q[: log.ticks, knee] += np.linspace(0.0, 0.5, log.ticks)
    log.zmp_measured[:50] = np.nan
    return log


@pytest.fixture(scope="module")
def chunks(log: RunLog, tmp_path_factory: pytest.TempPathFactory) -> list[Chunk]:
    folder = tmp_path_factory.mktemp("run")
    motion = still_motion(ROBOT, SECONDS)
    record(folder / "run.rrd", log, INFO, motion, same_human(motion))
    assert [path.name for path in folder.iterdir()] == ["run.rrd"]
    return RrdReader(folder / "run.rrd").stream().to_chunks()


def column(chunks: list[Chunk], entity: str, component: str) -> tuple[np.ndarray, pa.Array]:
    """Times [s] and values of a component that changes."""
    (chunk,) = [chunk for chunk in chunks if chunk.entity_path == entity and not chunk.is_static]
    batch = chunk.to_record_batch()
    (name,) = [name for name in batch.schema.names if name.endswith(component)]
    return batch.column("time").cast(pa.int64()).to_numpy() * 1e-9, batch.column(name)


def test_curves_keep_the_control_rate(chunks, log):
    times, values = column(chunks, "/joints/left_leg/angle", "Scalars:scalars")
    np.testing.assert_allclose(times, log.time[: log.ticks], atol=1e-9)
    angles = np.array(values.to_pylist())
    joints = list(ROBOT.groups["left_leg"])
    np.testing.assert_allclose(angles, np.rad2deg(log.q[: log.ticks, 7:][:, joints]), atol=1e-4)


def test_bodies_move_at_the_frame_rate(chunks):
    times, values = column(chunks, "/world/robot/LLEG4_LINK", "Transform3D:translation")
    assert len(times) == pytest.approx(SECONDS * FRAME_RATE, abs=1)
    places = np.array(values.to_pylist())[:, 0]
    assert np.linalg.norm(places[-1] - places[0]) > 0.1
    still = np.array(column(chunks, "/world/reference/LLEG4_LINK", "Transform3D:translation")[1].to_pylist())
    np.testing.assert_allclose(still, still[:1].repeat(len(still), axis=0), atol=1e-6)


def test_what_was_not_measured_is_not_shown(chunks):
    _, values = column(chunks, "/world/balance/zmp_measured", "Points3D:positions")
    shown = np.array([bool(row) for row in values.to_pylist()])
    assert not shown[: round(50 * PERIOD * FRAME_RATE) - 1].any()
    assert shown[round(50 * PERIOD * FRAME_RATE) + 1 :].all()


def test_everything_a_user_wants_to_see_is_there(chunks):
    entities = {chunk.entity_path for chunk in chunks}
    limbs = [f"/joints/{limb}" for limb in ("left_leg", "right_leg", "trunk", "left_arm", "right_arm")]
    assert entities >= {
        *("/world/human/bones", "/world/contact/left_foot", "/world/contact/support", "/world/balance/com"),
        *("/balance/x/zmp", "/balance/y/support", "/balance/load", "/balance/com_error", "/tick/time", "/tick/status"),
        *(f"{limb}/{part}" for limb in limbs for part in ("angle", "error", "room/limit", "torque/limits")),
        *("/tasks/balance\\:\\ com", "/tasks/posture\\:\\ joints", "/about"),
    }


def test_a_fallen_run_without_a_human_is_recorded_too(tmp_path: Path):
    motion = still_motion(ROBOT, SECONDS)
    log = perfect_log(motion)
    log.ticks = 3
    fallen = RunInfo("made-up", "hrp2", "cascade", "planted", 200.0, fell_at_s=0.01, reason="the waist sank")
    record(tmp_path / "run.rrd", log, fallen, motion, None)
    entities = {chunk.entity_path for chunk in RrdReader(tmp_path / "run.rrd").stream().to_chunks()}
    assert "/world/robot/BODY" in entities
    assert not any(entity.startswith("/world/human") for entity in entities)


@pytest.mark.parametrize("name", robots())
def test_shapes_belong_to_bodies_that_pinocchio_knows(name):
    robot = Robot.load(name)
    shapes = read_shapes(robot.path)
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


def test_a_mesh_is_shown_by_its_bounding_box(tmp_path: Path):
    (tmp_path / "mesh.xml").write_text(
        """<mujoco><asset><mesh name="m" vertex="0 0 0  0.2 0 0  0 0.4 0  0 0 0.6"/></asset><worldbody>
        <body name="part"><freejoint/><geom type="mesh" mesh="m"/><geom type="sphere" size="0.1" group="3"/></body>
        </worldbody></mujoco>"""
    )
    (shape,) = read_shapes(tmp_path / "mesh.xml")
    assert (shape.body, shape.kind) == ("part", "box")
    assert np.prod(2 * shape.half_sizes) >= 0.2 * 0.4 * 0.6 / 6


def test_a_model_that_mujoco_cannot_read(tmp_path: Path):
    (tmp_path / "bad.xml").write_text("<mujoco><nonsense/></mujoco>")
    with pytest.raises(InputError, match=r"bad\.xml: MuJoCo cannot read"):
        read_shapes(tmp_path / "bad.xml")


@pytest.mark.parametrize(("rate", "count"), [(60.0, 120), (1000.0, 400), (200.0, 400)])
def test_rows_at_a_lower_rate(log, rate, count):
    rows = log.rows_at(rate)
    assert len(rows) == pytest.approx(count, abs=1)
    assert (np.diff(rows) > 0).all()
    assert rows[0] == 0
    assert rows[-1] < log.ticks
