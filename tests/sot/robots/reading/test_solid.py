"""Shapes fitted about meshes: near them, and alike in both libraries."""

import coal
import mujoco
import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial import ConvexHull

from sot.robots.reading.solid import FIT_TOLERANCE, HULL_MAX_VERTICES, Mesh, Solid, fitted_primitive, fitted_solid
from sot.robots.reading.tree import Hinge, Link, Tree

GREY = (0.5, 0.5, 0.5, 1.0)


def cloud(kind: str) -> np.ndarray:
    """Vertices of a mesh: of a box, of a capsule along a slanting axis, or of a bent, pointed shape."""
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    if kind == "box":
        return np.array([(x, y, z) for x in (0, 0.1) for y in (0, 0.3) for z in (0, 0.4)])
    if kind == "capsule":
        return 0.05 * directions + np.sign(directions[:, 2:]) * (0.0, 0.0, 0.15)
    return np.vstack([0.05 * directions, 0.01 * directions + (0.0, 0.0, 0.3), 0.03 * directions + (0.1, 0.0, 0.0)])


def turned(vertices: np.ndarray) -> Mesh:
    place = pin.SE3(pin.rpy.rpyToMatrix(0.4, -0.3, 1.0), np.array([0.2, 0.1, -0.3]))
    return Mesh(vertices, np.eye(3), GREY).moved(place)


@pytest.mark.parametrize(("kind", "expected"), [("box", "box"), ("capsule", "capsule"), ("pointed", "hull")])
def test_what_is_fitted_is_near_the_mesh(kind, expected):
    """Its support in no direction further than a centimetre from the mesh's."""
    mesh = turned(cloud(kind))
    solid = fitted_solid("shape", [mesh])
    assert solid.kind == expected
    rng = np.random.default_rng(1)
    for direction in rng.normal(size=(300, 3)):
        direction /= np.linalg.norm(direction)
        own = Solid("", solid.kind, solid.size, solid.placement, solid.vertices)  # without the meshes it stands for
        support = (own.lowest_points(-direction) @ direction).max()
        assert abs(support - (mesh.vertices @ direction).max()) <= FIT_TOLERANCE
    if solid.vertices is not None:
        assert len(solid.vertices) <= HULL_MAX_VERTICES < len(ConvexHull(mesh.vertices).vertices)


def test_the_lowest_points_of_what_stands_for_a_mesh_are_the_meshs():
    mesh = turned(cloud("pointed"))
    lowest = fitted_solid("shape", [mesh]).lowest_points(np.array([0.0, 0.0, 1.0]))
    assert lowest[:, 2].min() == pytest.approx(mesh.vertices[:, 2].min(), abs=1e-12)


def test_looks_are_a_capsule_or_a_box():
    assert fitted_primitive([turned(cloud("capsule"))]).kind == "capsule"
    assert fitted_primitive([turned(cloud("box"))]).kind == "box"


def test_a_flat_mesh_is_a_thin_box():
    flat = np.array([(x, y, 0.0) for x in (0, 0.1) for y in (0, 0.2)])
    assert fitted_solid("plate", [Mesh(flat, np.eye(3), GREY)]).kind == "box"


@pytest.mark.parametrize("kind", ["sphere", "capsule", "cylinder", "ellipsoid", "box", "hull"])
def test_both_libraries_have_the_same_shape(kind):
    """Distances to a small sphere all round."""
    vertices = cloud("pointed") - cloud("pointed").mean(axis=0) if kind == "hull" else None
    place = pin.SE3(pin.rpy.rpyToMatrix(0.4, -0.3, 1.0), np.array([0.2, 0.1, -0.3]))
    solid = Solid("shape", kind, np.array([0.1, 0.15, 0.2]), place, vertices)
    probe = Solid("probe", "sphere", np.array([0.01, 0.0, 0.0]), pin.SE3.Identity())
    inertia = pin.Inertia(1.0, np.zeros(3), 0.1 * np.eye(3))
    arm = Link("arm", 0, pin.SE3.Identity(), (Hinge("turn", np.zeros(3), np.array([0.0, 1.0, 0.0])),), inertia)
    base = Link("base", -1, pin.SE3.Identity(), (), inertia, (solid,))
    for position in np.random.default_rng(2).normal(size=(20, 3)):
        moved = probe.moved(pin.SE3(np.eye(3), position))
        model = Tree("toy", (base, Link("arm", 0, arm.placement, arm.joints, inertia, (moved,)))).spec().compile()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        theirs = mujoco.mj_geomDistance(model, data, model.geom("shape").id, model.geom("probe").id, 10.0, None)
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        a, b = (coal.Transform3s(s.placement.rotation, s.placement.translation) for s in (solid, moved))
        ours = coal.distance(solid.coal(), a, probe.coal(), b, request, result)
        assert ours == pytest.approx(theirs, abs=2e-4)
