import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sot.motion.body import lean
from sot.motion.body.lean import lean_cut, lean_remark, with_leans_in_range
from sot.robots.lean_range import lean_of

PELVIS, TRUNK = np.array([[-0.5, -0.2], [0.6, 0.3]]), np.array([[-0.7, -0.2], [1.0, 0.3]])  # rad
HEADING = 0.7


@pytest.fixture
def limited(monkeypatch):
    """Leans of pelvis, chest and trunk within PELVIS and TRUNK, seen from HEADING: leans (n, 2) -> what comes of it."""
    monkeypatch.setattr(lean, "pelvis_leans", lambda robot: PELVIS)
    monkeypatch.setattr(lean, "trunk_leans", lambda robot: TRUNK)

    def of(leans):
        turns = Rotation.from_euler("z", HEADING) * Rotation.from_rotvec(
            np.column_stack([-leans[:, 1], leans[:, 0], np.zeros(len(leans))])
        )
        frames = dict.fromkeys(("pelvis", "chest", "head"), turns.as_matrix())
        directions = dict.fromkeys(("trunk", "head"), turns.apply([0.0, 0.0, 1.0]))
        return frames, directions, with_leans_in_range(None, frames, directions, np.full(len(leans), HEADING))

    return of


def from_heading(axes):
    return lean_of(Rotation.from_euler("z", -HEADING).apply(axes))


def test_leans_within_range_stay(limited):
    frames, directions, (limited_frames, limited_directions, cut) = limited(np.array([[0.0, 0.0], [0.5, 0.2]]))
    for name in frames:
        np.testing.assert_allclose(limited_frames[name], frames[name], atol=1e-9)
    np.testing.assert_allclose(limited_directions["trunk"], directions["trunk"], atol=1e-9)
    np.testing.assert_allclose(cut, 0.0, atol=1e-7)


def test_leans_beyond_are_the_nearest_within(limited):
    leans = np.array([[0.9, 0.1], [0.1, -0.8], [-1.0, 1.0]])
    frames, _, (found, directions, cut) = limited(leans)
    np.testing.assert_allclose(from_heading(found["pelvis"][:, :, 2]), np.clip(leans, *PELVIS), atol=1e-9)
    np.testing.assert_allclose(from_heading(found["chest"][:, :, 2]), np.clip(leans, *TRUNK), atol=1e-9)
    np.testing.assert_allclose(from_heading(directions["trunk"]), np.clip(leans, *TRUNK), atol=1e-9)
    np.testing.assert_allclose(found["head"], frames["head"])
    assert cut[0] == pytest.approx(0.0, abs=1e-7) and cut[1] == pytest.approx(0.6, abs=0.01)


def test_a_frame_turns_only_as_its_axis_does(limited):
    """No turn about the vertical comes in: the X axis stays as near as the lean lets it."""
    frames, _, (found, *_) = limited(np.array([[0.0, 0.9]]))
    np.testing.assert_allclose(found["pelvis"][0, :, 0], frames["pelvis"][0, :, 0], atol=1e-9)


def test_the_greatest_cut_is_told():
    assert lean_cut(np.array([0.0, 0.01]), 0.02) is None
    cut = lean_cut(np.array([0.1, 0.5, 0.2]), 0.02)
    assert (cut.angle, cut.time) == (0.5, 0.02)
    assert "by 29 degrees at 1.0 s" in lean_remark(cut, lambda t: t + 0.98)
