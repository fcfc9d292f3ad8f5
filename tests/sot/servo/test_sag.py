"""The sag of a foot against a sole on springs."""

import numpy as np

from sot.hardware.compliance import FootCompliance
from sot.servo.load_sharing import FootLoad
from sot.servo.sag import bush_compliance, sag_offset

BUSH = np.array([0.01, -0.02, 0.07])


def test_the_springs_under_a_load_undo_the_offset():
    """The foot turned by the offset, its sole flat: the bush's moment, force and the load's are in balance."""
    compliance = FootCompliance(700.0, 500.0, 2e5)
    load = FootLoad(np.array([20.0, -15.0, 400.0]), np.array([9.0, -14.0, 1.0]))
    offset = sag_offset(load, bush_compliance(compliance), BUSH)
    sole_against_foot = -offset[:2]
    moment = load.moment + np.cross(-BUSH, load.force)
    np.testing.assert_allclose([700.0, 500.0] * sole_against_foot, moment[:2])
    np.testing.assert_allclose(-2e5 * offset[2], load.force[2])


def test_a_sole_that_cannot_move_up_does_not():
    offset = sag_offset(
        FootLoad(np.array([0.0, 0.0, 400.0]), np.zeros(3)), bush_compliance(FootCompliance(700.0, 500.0)), BUSH
    )
    assert offset[2] == 0.0
