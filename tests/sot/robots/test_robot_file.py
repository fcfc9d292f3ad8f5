"""Robot files: unknown keys, groups that are empty or share joints, joints in none."""

import pytest

from sot.errors import InputError
from tests.sot.robots.variants import load_variant

HEAD = 'head = ["HEAD0", "HEAD1"]'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[limits]", "[limit]", "no robot file has 'limit' (did you mean 'limits'?)"),
        ('label = "HRP-2-like"', 'label = "x"\nrotation = 90', "no robot file has 'rotation'"),
        ("[groups]", "[groups]\nneck = []", "no robot file has 'groups.neck'"),
        ("left_foot = [", "left_feet = [", "no robot file has 'soles.left_feet' (did you mean 'left_foot'?)"),
        ('neck = "neck"', 'nek = "neck"', "'points' lacks neck (is it 'nek'?)"),
        ('neck = "neck"', 'neck = "nec"', "which the model does not have (did you mean 'neck'?)"),
        ('neck = "neck"', 'neck = { frame = "neck", pos = [0, 0, 0] }', "no robot file has 'points.neck.pos'"),
        ('neck = "neck"', "neck = { frame = 3, position = [0, 0, 0] }", "'points.neck.frame' must be a str"),
        ('neck = "neck"', 'neck = { frame = "neck", position = [0, 0, inf] }', "must be three numbers [m]"),
        (HEAD, 'head = ["HEAD0", "CHEST1"]', "'groups.head' names 'CHEST1', which is in 'chest' already"),
        (HEAD, 'head = "HEAD0"', "'groups.head' must be a list"),
        ('"half_sitting"', '"half_siting"', "does not have (did you mean 'half_sitting'?)"),
        ("[groups]", "[locked]\nHEAD9 = 0.0\n\n[groups]", "no joint 'HEAD9' to lock"),
    ],
)
def test_a_mistake_is_told_with_what_is_meant(tmp_path, old, new, message):
    with pytest.raises(InputError) as error:
        load_variant(tmp_path, file=[(old, new)])
    assert message in str(error.value) and "\n" not in str(error.value)


def test_groups_may_be_empty_and_joints_in_none(tmp_path):
    robot = load_variant(tmp_path, file=[(HEAD, "head = []")])
    assert robot.groups["head"] == ()
    assert robot.remarks == ("joints in no group keep still: HEAD0, HEAD1",)


def test_locked_joints_of_an_mjcf_are_no_joints(tmp_path):
    locked = ("[groups]", "[locked]\nHEAD0 = 0.1\nHEAD1 = 0.2\n\n[groups]")
    velocities = ("HEAD0 = 7.854\nHEAD1 = 7.854\n", "")
    robot = load_variant(tmp_path, file=[locked, (HEAD, "head = []"), velocities])
    assert robot.na == 28 and robot.remarks == ()
    assert robot.mass == pytest.approx(58.0)
