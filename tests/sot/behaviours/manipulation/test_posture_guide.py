"""The posture's reference: joints that yield are where they are, and are led back smoothly."""

from types import SimpleNamespace

import numpy as np

from sot.behaviours.manipulation.posture_guide import PostureGuide

ARM = np.array([1, 2])


def observed(guide, *joints):
    guide.observe(SimpleNamespace(q=np.array([*np.zeros(7), *joints, 9.0])))  # a thing's coordinate comes last
    return guide


def test_joints_yield_and_are_led_back_without_a_jump():
    guide = PostureGuide(np.array([0.1, 0.2, 0.3]))
    np.testing.assert_allclose(observed(guide, 0.0, 0.0, 0.0)(1.0)[0], [0.1, 0.2, 0.3])
    guide.let_yield(ARM)
    np.testing.assert_allclose(observed(guide, 0.0, 0.7, -0.4)(2.0)[0], [0.1, 0.7, -0.4])
    guide.lead_back(ARM, 3.0, 2.0)
    np.testing.assert_allclose(observed(guide, 0.0, 5.0, 5.0)(3.0)[0], [0.1, 0.7, -0.4])
    np.testing.assert_allclose(guide(4.0)[0], [0.1, 0.45, -0.05])
    np.testing.assert_allclose(guide(5.0)[0], [0.1, 0.2, 0.3])
