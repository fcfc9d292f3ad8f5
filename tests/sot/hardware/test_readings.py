"""The zero-moment point of the feet's force sensors."""

import numpy as np
import pinocchio as pin
import pytest

from sot.hardware.readings import measured_zmp


def test_zmp_is_where_forces_on_the_floor_have_no_horizontal_moment():
    """Kim & Oh (29), (30) against forces at points of the floor, felt by feet that are turned and off the floor."""
    rng = np.random.default_rng(0)
    feet, wrenches, points, forces = {}, {}, [], []
    for foot in ("left_foot", "right_foot"):
        feet[foot] = at = pin.SE3(pin.exp3(0.2 * rng.normal(size=3)), rng.normal(size=3))
        point, force = np.append(rng.normal(size=2), 0.0), np.array([*rng.normal(size=2), rng.uniform(1.0, 2.0)])
        moment = np.cross(point - at.translation, force)
        wrenches[foot] = np.concatenate([at.rotation.T @ force, at.rotation.T @ moment])
        points.append(point), forces.append(force)
    loads = np.array(forces)[:, 2]
    np.testing.assert_allclose(measured_zmp(wrenches, feet), loads @ np.array(points)[:, :2] / loads.sum(), atol=1e-12)


@pytest.mark.parametrize("load", [0.0, -1.0, np.nan])
def test_zmp_is_no_number_without_load(load):
    wrench = np.array([0.0, 0.0, load, 0.0, 0.0, 0.0])
    assert np.isnan(measured_zmp({"left_foot": wrench}, {"left_foot": pin.SE3.Identity()})).all()
