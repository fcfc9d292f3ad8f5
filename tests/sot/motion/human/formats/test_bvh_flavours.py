"""BVH as other programs write it: one dance, the same human from each; and in a mirror or a wrong order, none."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sot.errors import InputError
from sot.motion import Human, read, recognise
from tests.sot.motion.human.formats.comparison import dancing_human, largest_angle
from tests.sot.motion.human.formats.dance import dance, mirrored
from tests.sot.motion.human.formats.writers import renamed_bvh

TRUNK = ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head")
ARM, LEG = ("Shoulder", "Arm", "ForeArm", "Hand"), ("UpLeg", "Leg", "Foot", "ToeBase")


def names(
    trunk: str, arm: str, leg: str, left: str = "Left", right: str = "Right", behind: bool = False
) -> dict[str, str]:
    """Our joint -> theirs; a dash is a joint that they do not have."""
    found = {ours: theirs for ours, theirs in zip(TRUNK, trunk.split(), strict=True) if theirs != "-"}
    for ours, side in (("Left", left), ("Right", right)):
        for joints, theirs in ((ARM, arm.split()), (LEG, leg.split())):
            named = {
                ours + joint: name + side if behind else side + name for joint, name in zip(joints, theirs, strict=True)
            }
            found |= {joint: name for joint, name in named.items() if "-" not in name.replace("1-1", "")}
    return found


@dataclass(frozen=True)
class Flavour:
    names: dict[str, str]
    options: dict[str, Any] = field(default_factory=dict)


MOTIONBUILDER = names("Hips Spine Spine1 Spine2 Neck Head", "Shoulder Arm ForeArm Hand", "UpLeg Leg Foot ToeBase")
FLAVOURS = {
    "makehuman": Flavour(
        names(
            "root spine05 spine03 spine01 neck01 head",
            "clavicle upperarm01 lowerarm01 wrist",
            "upperleg01 lowerleg01 foot toe1-1",
            ".L",
            ".R",
            behind=True,
        ),
        {
            "split": {
                f"{side}{joint}": f"{bone}02.{side[0]}"
                for side in ("Left", "Right")
                for joint, bone in (
                    ("UpLeg", "upperleg"),
                    ("Leg", "lowerleg"),
                    ("Arm", "upperarm"),
                    ("ForeArm", "lowerarm"),
                )
            }
        },
    ),
    "mocapnet": Flavour(
        names("hip abdomen chest neck neck1 head", "Collar Shldr ForeArm Hand", "Thigh Shin Foot -", "l", "r")
    ),
    "soma": Flavour(
        names("Hips Spine1 Spine2 Chest Neck1 Head", "Shoulder Arm ForeArm Hand", "Leg Shin Foot ToeBase"),
        {"order": "ZYX", "everywhere": True, "turned": True, "root": "Root", "six": True},
    ),
    "nokov": Flavour(MOTIONBUILDER, {"order": "ZYX"}),
    "xsens": Flavour(
        names("Hips Chest Chest2 Chest3 Neck Head", "Collar Shoulder Elbow Wrist", "Hip Knee Ankle Toe"),
        {"order": "YXZ"},
    ),
    "xsens for 3ds Max": Flavour(
        names(
            "Bip01 Spine Spine1 Spine2 Neck Head",
            " Clavicle  UpperArm  Forearm  Hand",
            " Thigh  Calf  Foot  Toe0",
            "L",
            "R",
        ),
        {"order": "ZXY", "turned": True},
    ),
    "rokoko": Flavour(
        names("Hips Spine1 Spine2 Spine4 Neck Head", "Shoulder Arm ForeArm Hand", "Thigh Shin Foot Toe"),
        {"order": "YXZ", "everywhere": True},
    ),
    "perception neuron": Flavour(
        names("Hips Spine Spine1 Spine2 Neck Head", "Shoulder Arm ForeArm Hand", "UpLeg Leg Foot -"),
        {"order": "YXZ", "everywhere": True},
    ),
}


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Human:
    return dancing_human(tmp_path_factory.mktemp("clip"))


def written(folder: Path, flavour: Flavour, **changes: Any) -> Path:
    one = changes.pop("dance", None) or dance()
    path = folder / "clip.bvh"
    path.write_text(renamed_bvh(one, flavour.names, **(flavour.options | changes)))
    return path


@pytest.mark.parametrize("name", FLAVOURS)
def test_every_flavour_is_the_same_human(tmp_path: Path, expected: Human, name: str) -> None:
    human = recognise(read(written(tmp_path, FLAVOURS[name])))
    assert largest_angle(expected, human) < 0.1
    assert human.leg == pytest.approx(expected.leg, abs=1e-3)
    for joint in ("left_wrist", "right_knee", "left_ankle", "right_shoulder", "neck"):
        np.testing.assert_allclose(human.points[joint], expected.points[joint], atol=2e-3)
    assert human.remarks == ()


@pytest.mark.parametrize("name", FLAVOURS)
def test_in_a_mirror_every_flavour_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="backwards"):
        recognise(read(written(tmp_path, FLAVOURS[name], dance=mirrored(dance()))))


@pytest.mark.parametrize("name", ["soma", "xsens for 3ds Max"])
def test_angles_about_fixed_axes_in_place_of_turned_ones_are_refused(tmp_path: Path, name: str) -> None:
    """Where each joint has axes of its own, the reverse order makes no human; elsewhere it may make another one."""
    flavour = FLAVOURS[name]
    with pytest.raises(InputError) as error:
        recognise(read(written(tmp_path, flavour, values_order=flavour.options["order"][::-1])))
    assert "\n" not in str(error.value)


def test_values_in_the_wrong_columns_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "clip.bvh"
    text = renamed_bvh(dance(), MOTIONBUILDER, order="XYZ")
    path.write_text(text.replace("Xrotation Yrotation Zrotation", "Zrotation Yrotation Xrotation"))
    with pytest.raises(InputError, match="its knees do not bend to where its toes point"):
        recognise(read(path))
