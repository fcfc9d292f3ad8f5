"""Any skeleton under canonical names, with the bodies' frames calibrated, and a human's own operations."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.errors import InputError, UnknownSkeletonError
from sot.motion import SEGMENTS, Capture, Human, read, recognise
from sot.motion.human.skeleton import CANONICAL_JOINTS, naming_conventions

ROOT = Path(__file__).parents[4]
GROOVE = ROOT / "scenarios/inputs/data/groove.bvh"
MOCAP = ROOT / "../shared/mocap"


@pytest.fixture(scope="module")
def capture() -> Capture:
    return read(GROOVE)


@pytest.fixture(scope="module")
def human(capture: Capture) -> Human:
    return recognise(capture)


def renamed(capture: Capture, names: dict[str, str]) -> Capture:
    return replace(capture, joints=tuple(names.get(name, name) for name in capture.joints))


def tilt_deg(rotations: np.ndarray) -> np.ndarray:
    return np.degrees(Rotation.from_matrix(rotations).magnitude())


@pytest.mark.parametrize("convention", sorted(naming_conventions()))
@pytest.mark.parametrize("prefix", ["", "mixamorig:", "Character1_"])
def test_every_convention_names_the_same_human(capture: Capture, human: Human, convention: str, prefix: str) -> None:
    ours = naming_conventions()["motionbuilder"]
    theirs = naming_conventions()[convention]
    names = {ours[joint][0]: prefix + theirs[joint][-1].upper() for joint in CANONICAL_JOINTS}
    names |= {name: f"other {i}" for i, name in enumerate(capture.joints) if name not in names}
    other = recognise(renamed(capture, names))
    for name, position in human.points.items():
        np.testing.assert_array_equal(other.points[name], position)


def test_proportions(human: Human) -> None:
    assert human.leg == pytest.approx(0.85, abs=1e-3)
    assert human.arm == pytest.approx(0.54, abs=1e-3)
    np.testing.assert_allclose(human.points["waist"][0, :2], 0, atol=1e-6)
    for side, sign in (("left", 1), ("right", -1)):
        for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe"):
            assert sign * human.points[f"{side}_{name}"][0, 1] > 0.05


def test_standing_at_rest_all_bodies_are_upright_and_look_ahead(human: Human) -> None:
    for frames in (human.pelvis_frame(), human.chest_frame(), human.head_frame()):
        assert tilt_deg(frames[0]) < 6.0
        np.testing.assert_allclose(frames.swapaxes(1, 2) @ frames, np.broadcast_to(np.eye(3), frames.shape), atol=1e-9)
    lateral = human.points["left_hip"] - human.points["right_hip"]
    lateral /= np.linalg.norm(lateral, axis=1, keepdims=True)
    np.testing.assert_allclose(human.pelvis_frame()[:, :, 1], lateral, atol=2e-3)


def test_how_a_file_lays_its_axes_does_not_matter(capture: Capture, human: Human) -> None:
    layout = Rotation.random(len(capture.joints), rng=np.random.default_rng(0)).as_matrix()
    head = capture.joints.index("Head")
    layout[head] = Rotation.from_euler("XZ", [90, -90], degrees=True).as_matrix()  # one of the aligned ones
    other = recognise(replace(capture, rotations=capture.rotations @ layout))
    for body, frames in human.frames.items():
        np.testing.assert_allclose(other.frames[body], frames, atol=1e-9)


def test_a_head_turned_all_the_time_stays_turned(capture: Capture) -> None:
    """As a boxer's: the average over the clip is not its zero where the joint's axes say where that is."""
    turn = Rotation.from_euler("Z", 25, degrees=True).as_matrix()
    rotations = capture.rotations.copy()
    head = capture.joints.index("Head")
    rotations[:, head] = turn @ rotations[:, head]
    straight = recognise(capture).head_frame()
    np.testing.assert_allclose(
        recognise(replace(capture, rotations=rotations)).head_frame(), turn @ straight, atol=0.03
    )


def test_wrists_and_toes_need_no_name(capture: Capture, human: Human) -> None:
    names = {f"{side}{joint}": f"x{side}{joint}" for side in ("Left", "Right") for joint in ("Hand", "ToeBase")}
    other = recognise(renamed(capture, names))
    assert other.points["left_toe"][0, 0] > human.points["left_toe"][0, 0] > 0.1
    assert other.arm > human.arm  # to the end of the hand


def test_names_that_are_nearly_known_are_offered(capture: Capture) -> None:
    strange = renamed(capture, {"LeftForeArm": "Left-Fore_Arm2", "Head": 'the "Head"\t'})
    with pytest.raises(UnknownSkeletonError, match='left_elbow may be "Left-Fore_Arm2"') as error:
        recognise(strange)
    assert 'left_elbow = ""  # may be "Left-Fore_Arm2"' in error.value.mapping
    assert tomllib.loads(error.value.mapping)["right_elbow"] == "RightForeArm"


def test_unknown_names_ask_for_a_mapping(capture: Capture, tmp_path: Path) -> None:
    strange = renamed(capture, {"LeftLeg": "Genou gauche", "Head": "Tête"})
    with pytest.raises(UnknownSkeletonError, match=r"unknown skeleton \(not found: head, left_knee\)") as error:
        recognise(strange)
    assert 'left_knee may be "Genou gauche"; complete the mapping' in str(error.value)
    assert "\n" not in str(error.value)
    draft = tomllib.loads(error.value.mapping)
    assert draft["left_ankle"] == "LeftFoot" and draft["left_knee"] == draft["head"] == ""
    assert '"Tête"' in error.value.mapping.splitlines()[-1]
    completed = draft | {"left_knee": "Genou gauche", "head": "Tête"}
    np.testing.assert_array_equal(recognise(strange, completed).points["head"], recognise(capture).points["head"])
    table = {joint: names[0] for joint, names in naming_conventions()["motionbuilder"].items()}
    table |= {"left_knee": "Genou gauche", "head": "Tête"}
    file = tmp_path / "skeleton.toml"
    file.write_text("".join(f'{joint} = "{name}"\n' for joint, name in table.items()), encoding="utf-8")
    expected = recognise(capture)
    for mapping in (file, str(file), table):
        np.testing.assert_array_equal(recognise(strange, mapping).points["left_knee"], expected.points["left_knee"])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('left_knee = "Nobody"', 'left_knee = "Nobody" is no joint of groove'),
        ('left_patella = "LeftLeg"', "'left_patella' is no canonical joint"),
        ("left_knee = 3", "'left_knee' needs a joint's name"),
        ("left_knee = []", "'left_knee' needs a joint's name"),
        ("left_knee = LeftLeg", "not a TOML file"),
        ('left_knee = "LeftLeg"', "leaves out head, left_hip"),
    ],
)
def test_a_wrong_mapping_says_so(capture: Capture, tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "skeleton.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as error:
        recognise(capture, file)
    assert "\n" not in str(error.value)
    with pytest.raises(InputError, match="cannot be read"):
        recognise(capture, tmp_path / "absent.toml")


def test_names_must_agree_with_the_body(capture: Capture) -> None:
    table = {joint: names[0] for joint, names in naming_conventions()["motionbuilder"].items()}
    crossed = table | {"left_knee": "RightLeg"}
    with pytest.raises(InputError, match=r"left_knee \(RightLeg\) is not below left_hip"):
        recognise(capture, crossed)
    swapped = {
        joint.replace("left", "?").replace("right", "left").replace("?", "right"): n for joint, n in table.items()
    }
    with pytest.raises(InputError, match="left and right swapped"):
        recognise(capture, swapped)
    same = table | {
        "right_hip": "LeftUpLeg",
        "right_knee": "LeftLeg",
        "right_ankle": "LeftFoot",
        "right_toe": "LeftToeBase",
    }
    with pytest.raises(InputError, match="cannot be the two hips"):
        recognise(capture, same)


def test_coinciding_joints_are_refused(capture: Capture) -> None:
    positions = capture.positions.copy()
    positions[7, capture.joints.index("LeftHand")] = positions[7, capture.joints.index("LeftForeArm")]
    with pytest.raises(InputError, match="left_elbow and left_wrist coincide in frame 7"):
        recognise(replace(capture, positions=positions))


def test_segments_have_unit_directions(human: Human) -> None:
    for segment, (near, far) in SEGMENTS.items():
        along = human.points[far] - human.points[near]
        direction = human.segment_direction(segment)
        np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, atol=1e-12)
        np.testing.assert_allclose(direction * np.linalg.norm(along, axis=1, keepdims=True), along, atol=1e-12)


def test_slice(human: Human) -> None:
    part = human.slice(2.0, 3.0)
    assert part.count == 151
    assert part.duration == pytest.approx(3.0)
    np.testing.assert_array_equal(part.points["left_wrist"], human.points["left_wrist"][100:251])
    np.testing.assert_array_equal(part.head_frame(), human.head_frame()[100:251])
    assert human.slice(11.0, 60.0).duration == pytest.approx(1.0)
    for start, duration in ((12.0, None), (-1.0, None), (2.0, 0.0)):
        with pytest.raises(InputError, match=r"lasts 12\.00 s"):
            human.slice(start, duration)


def test_resampling_meets_the_frames_and_stays_between_them(human: Human) -> None:
    fine = human.resampled(1000.0)
    assert fine.count == 12001
    np.testing.assert_allclose(fine.points["right_wrist"][::20], human.points["right_wrist"], atol=1e-9)
    np.testing.assert_allclose(fine.chest_frame()[::20], human.chest_frame(), atol=1e-9)
    back = human.resampled(25.0).resampled(50.0)
    assert np.abs(back.points["right_wrist"] - human.points["right_wrist"]).max() < 2e-3
    assert tilt_deg(back.head_frame().swapaxes(1, 2) @ human.head_frame()).max() < 0.6


def test_low_pass_takes_the_fast_and_leaves_the_slow_in_time(human: Human) -> None:
    t = human.times
    shake = 0.02 * np.sin(2 * np.pi * 18.0 * t)[:, None]
    tremble = Rotation.from_euler("X", 0.1 * np.sin(2 * np.pi * 18.0 * t)[:, None]).as_matrix()
    rough = replace(
        human,
        points={name: position + shake for name, position in human.points.items()},
        frames={body: frames @ tremble for body, frames in human.frames.items()},
    ).low_passed(6.0)
    inner = slice(25, -25)
    assert np.abs(rough.points["left_wrist"] - human.points["left_wrist"])[inner].max() < 4e-3
    assert tilt_deg(rough.head_frame().swapaxes(1, 2) @ human.head_frame())[inner].max() < 0.4
    assert human.low_passed(25.0) is human


def test_scaled(human: Human) -> None:
    small = human.scaled(0.7)
    assert small.leg == pytest.approx(0.7 * human.leg)
    np.testing.assert_allclose(small.segment_direction("trunk"), human.segment_direction("trunk"), atol=1e-12)


@pytest.mark.skipif(not MOCAP.is_dir(), reason="needs the shared clips")
@pytest.mark.parametrize("name", ["perfume_A", "perfume_B", "bandai_punch", "bandai_walk"])
def test_real_clips(name: str) -> None:
    human = recognise(read(MOCAP / f"{name}.bvh"))
    assert 0.7 < human.leg < 0.9
    assert 0.4 < human.arm < 0.6
    for side in ("left", "right"):
        assert 0.05 < np.percentile(human.points[f"{side}_ankle"][:, 2], 3) < 0.13
        knee = human.points[f"{side}_knee"] - 0.5 * (human.points[f"{side}_hip"] + human.points[f"{side}_ankle"])
        assert np.mean(np.sum(knee * human.pelvis_frame()[:, :, 0], axis=1)) > 0  # knees bend ahead
    assert abs(np.median(human.head_frame()[:, 2, 0])) < np.sin(np.radians(12))  # it looks to the horizon, mostly
    across = np.sum(human.pelvis_frame()[:, :, 0] * human.chest_frame()[:, :, 0], axis=1)
    assert np.median(across) > np.cos(np.radians(20))
