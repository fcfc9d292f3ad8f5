"""From a file's own units and axes to metres, Z up and heading +X, whatever the file does."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.errors import InputError
from sot.motion import Capture, read
from sot.motion.human.capture import find_legs
from sot.motion.human.formats.bvh import read_bvh
from sot.motion.human.world import to_world

ROOT = Path(__file__).parents[4]
GROOVE = ROOT / "scenarios/inputs/data/groove.bvh"
MOCAP = ROOT / "../shared/mocap"


@pytest.fixture(scope="module")
def recorded() -> Capture:
    return read_bvh(GROOVE)


@pytest.fixture(scope="module")
def expected(recorded: Capture) -> Capture:
    return to_world(recorded)


def moved(capture: Capture, turn: np.ndarray, scale: float = 1.0, shift: tuple[float, ...] = (0, 0, 0)) -> Capture:
    return replace(
        capture, positions=scale * capture.positions @ turn.T + np.array(shift), rotations=turn @ capture.rotations
    )


def test_lands_in_the_world_frame(expected: Capture) -> None:
    position = dict(zip(expected.joints, expected.positions.transpose(1, 0, 2), strict=True))
    np.testing.assert_allclose(0.5 * (position["LeftUpLeg"] + position["RightUpLeg"])[0, :2], 0, atol=1e-9)
    assert position["LeftUpLeg"][0, 1] == pytest.approx(0.09, abs=1e-6)  # left is +Y, so ahead is +X
    assert position["LeftToeBase"][0, 0] > 0.1
    assert position["Head"][0, 2] == pytest.approx(1.5, abs=0.1)
    assert position["LeftToeBase"][:, 2].min() == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("unit", [0.01, 0.0254, 0.0254 / 0.45, 1.0, 0.001])
def test_the_size_of_the_legs_gives_the_unit(recorded: Capture, expected: Capture, unit: float) -> None:
    other = to_world(moved(recorded, np.eye(3), 0.01 / unit))
    np.testing.assert_allclose(other.positions, expected.positions, atol=1e-9)


def test_an_unknown_unit_gives_average_legs(recorded: Capture) -> None:
    other = to_world(moved(recorded, np.eye(3), 4.0 / 85.0))
    leg, _ = find_legs(other)
    chain = other.positions[0, [leg.hip, leg.knee, leg.ankle]]
    assert sum(np.linalg.norm(lower - upper) for upper, lower in pairwise(chain)) == pytest.approx(0.85, abs=1e-6)


@pytest.mark.parametrize("axes", ["Y up", "Z up", "Z down"])
@pytest.mark.parametrize("heading", [0.0, 130.0, -90.0])
def test_up_and_ahead_are_found(recorded: Capture, expected: Capture, axes: str, heading: float) -> None:
    up = {"Y up": 0.0, "Z up": 90.0, "Z down": -90.0}[axes]
    turn = (Rotation.from_euler("X", up, degrees=True) * Rotation.from_euler("Y", heading, degrees=True)).as_matrix()
    other = to_world(moved(recorded, turn, shift=(300.0, -20.0, 70.0)))
    np.testing.assert_allclose(other.positions, expected.positions, atol=1e-9)
    np.testing.assert_allclose(other.rotations, expected.rotations, atol=1e-9)


@pytest.mark.parametrize("held", [1, 4])
def test_drops_a_reference_pose(recorded: Capture, expected: Capture, held: int) -> None:
    pose = recorded.positions[0] @ Rotation.from_euler("Y", 90, degrees=True).as_matrix().T + [0.0, 0.0, 50.0]
    positions = np.concatenate([np.tile(pose, (held, 1, 1)), recorded.positions])
    rotations = np.concatenate([recorded.rotations[:held], recorded.rotations])
    other = to_world(replace(recorded, positions=positions, rotations=rotations))
    np.testing.assert_allclose(other.positions, expected.positions, atol=1e-9)


def test_keeps_a_fast_start(recorded: Capture) -> None:
    positions = recorded.positions.copy()
    positions[:, :, 2] += 20.0 * np.arange(len(positions))[:, None]  # 10 m/s from the first frame on
    assert to_world(replace(recorded, positions=positions)).frames == recorded.frames


def test_a_jump_or_a_dip_leaves_the_floor_where_it_is(recorded: Capture, expected: Capture) -> None:
    positions = recorded.positions.copy()
    positions[100:120, :, 1] += 40.0
    positions[200:203, :, 1] -= 30.0
    other = to_world(replace(recorded, positions=positions))
    np.testing.assert_allclose(other.positions[0], expected.positions[0], atol=1e-3)


def test_legs_are_found_without_names(recorded: Capture) -> None:
    found = {tuple(recorded.joints[j] for j in (leg.hip, leg.knee, leg.ankle, leg.tip)) for leg in find_legs(recorded)}
    assert found == {(f"{s}UpLeg", f"{s}Leg", f"{s}Foot", f"{s}ToeBase_end") for s in ("Left", "Right")}


def test_needs_legs(recorded: Capture) -> None:
    keep = [i for i, name in enumerate(recorded.joints) if "Right" not in name]
    parents = tuple(keep.index(recorded.parents[i]) if i else -1 for i in keep)
    one_sided = replace(
        recorded,
        joints=tuple(recorded.joints[i] for i in keep),
        parents=parents,
        positions=recorded.positions[:, keep],
        rotations=recorded.rotations[:, keep],
    )
    with pytest.raises(InputError, match="no pair of legs"):
        to_world(one_sided)


@pytest.mark.skipif(not MOCAP.is_dir(), reason="needs the shared clips")
@pytest.mark.parametrize("name", ["perfume_A", "perfume_B", "bandai_punch", "bandai_walk"])
def test_real_clips(name: str) -> None:
    capture = read(MOCAP / f"{name}.bvh")
    legs = find_legs(capture)
    for leg in legs:
        chain = capture.positions[0, [leg.hip, leg.knee, leg.ankle]]
        assert 0.7 < sum(np.linalg.norm(lower - upper) for upper, lower in pairwise(chain)) < 0.9
    assert capture.frames == {"perfume_A": 1299, "perfume_B": 1299, "bandai_punch": 224, "bandai_walk": 195}[name]
    assert capture.positions[:, :, 2].min() > -0.06
    assert 1.2 < capture.positions[0, :, 2].max() < 1.8
    if name == "bandai_walk":
        assert capture.positions[-1, legs[0].hip, 0] > 7.0  # it walks ahead
        assert abs(capture.positions[-1, legs[0].hip, 1]) < 1.0
