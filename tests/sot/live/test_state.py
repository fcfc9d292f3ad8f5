"""The state of one moment is that of the batch code."""

import numpy as np

from sot.live.state import coordinate_columns, pinocchio_state
from sot.motion.body.coordinates import to_pinocchio, to_velocity


def test_it_is_a_row_of_the_batch():
    chance = np.random.default_rng(1)
    for _ in range(20):
        y, dy, ddy = chance.normal(size=(3, 12))
        y[4] *= 0.4
        q, v, a = pinocchio_state(y, dy, ddy)
        wanted_q, wanted_v, wanted_a = (part[0] for part in to_pinocchio(y[None], dy[None], ddy[None]))
        q[3:7] *= np.sign(q[3:7] @ wanted_q[3:7])  # a quaternion and its negative are one rotation
        np.testing.assert_allclose(q, wanted_q, atol=1e-12)
        np.testing.assert_allclose(v, wanted_v, atol=1e-12)
        np.testing.assert_allclose(a, wanted_a, atol=1e-12)


def test_a_jacobian_on_rates_of_coordinates_gives_the_same_rates():
    chance = np.random.default_rng(2)
    for _ in range(5):
        (y, dy), J = chance.normal(size=(2, 12)), chance.normal(size=(4, 12))
        np.testing.assert_allclose(coordinate_columns(J, y) @ dy, J @ to_velocity(y[None], dy[None])[0], atol=1e-12)
