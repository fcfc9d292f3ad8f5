"""Nearest points in closed form against those of a general solver."""

import coal
import numpy as np
import pinocchio as pin
import pytest

from sot.proximity.cores import BOX, SEGMENT, Cores, measure_cores

SHAPES = {
    "sphere": lambda rng: coal.Sphere(rng.uniform(0.02, 0.3)),
    "capsule": lambda rng: coal.Capsule(rng.uniform(0.02, 0.2), rng.uniform(0.05, 0.8)),
    "box": lambda rng: coal.Box(*rng.uniform(0.02, 0.8, 3)),
}
PAIRS = [(a, b) for a in SHAPES for b in SHAPES if (a, b) != ("box", "box")]
INDICES, FIRST = np.array([[0, 1]]), np.array([0])


def measured(shapes, places):
    cores = Cores.of([pin.GeometryObject(str(k), 0, pin.SE3.Identity(), shape) for k, shape in enumerate(shapes)])
    rotations, translations = (np.array([getattr(at, of) for at in places]) for of in ("rotation", "translation"))
    distance, normal, point = np.empty(1), np.empty((1, 3)), np.empty((1, 3))
    told = measure_cores(INDICES, FIRST, *cores, rotations, translations, distance, normal, point)
    return told, distance[0], normal[0], point[0]


def by_coal(shapes, places):
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    request.gjk_tolerance = 1e-12
    transforms = [coal.Transform3s(at.rotation, at.translation) for at in places]
    distance = coal.distance(shapes[0], transforms[0], shapes[1], transforms[1], request, result)
    return distance, result.normal, result.getNearestPoint2()


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_distances_normals_and_points_are_those_of_a_general_solver(first, second):
    rng, apart = np.random.default_rng(0), 0
    pin.seed(0)
    for _ in range(300):
        shapes = [SHAPES[first](rng), SHAPES[second](rng)]
        places = [pin.SE3.Random() for _ in shapes]
        for at in places:
            at.translation = rng.uniform(-0.7, 0.7, 3)
        told, distance, normal, point = measured(shapes, places)
        expected, expected_normal, expected_point = by_coal(shapes, places)
        if expected < 1e-3:
            continue
        apart += 1
        assert told
        assert distance == pytest.approx(expected, abs=1e-8)
        np.testing.assert_allclose(normal, expected_normal, atol=1e-4)
        np.testing.assert_allclose(point, expected_point, atol=1e-4)
    assert apart > 50


def test_segments_that_are_parallel_or_end_before_each_other():
    capsules = [coal.Capsule(0.1, 1.0), coal.Capsule(0.2, 0.6)]
    for offset, expected in (([0.5, 0.0, 0.3], 0.2), ([0.3, 0.0, 1.2], 0.5 - 0.3), ([0.0, 0.0, 1.5], 0.7 - 0.3)):
        told, distance, _, _ = measured(capsules, [pin.SE3.Identity(), pin.SE3(np.eye(3), np.array(offset))])
        assert told and distance == pytest.approx(expected)


def test_shapes_overlap_by_as_much_as_their_radii_exceed_the_distance_of_their_cores():
    shapes = [coal.Capsule(0.1, 1.0), coal.Box(0.4, 0.4, 0.4)]
    told, distance, normal, _ = measured(shapes, [pin.SE3(np.eye(3), np.array([0.25, 0.0, 0.0])), pin.SE3.Identity()])
    assert told and distance == pytest.approx(-0.05)
    np.testing.assert_allclose(normal, [-1.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("shape", [coal.Box(0.4, 0.4, 0.4), coal.Cylinder(0.1, 0.4)])
def test_what_cannot_be_told_is_said(shape):
    """Two boxes, shapes of other kinds, and cores that meet are for a general solver."""
    told, distance, _, _ = measured([coal.Box(0.2, 0.2, 0.2), shape], [pin.SE3.Identity(), pin.SE3.Random()])
    assert not told and np.isnan(distance)
    told, distance, _, _ = measured([coal.Capsule(0.1, 1.0), shape], [pin.SE3.Identity(), pin.SE3.Identity()])
    assert not told and np.isnan(distance)


def test_kinds_and_radii():
    cores = Cores.of(
        [
            pin.GeometryObject("shape", 0, pin.SE3.Identity(), shape)
            for shape in (coal.Sphere(0.1), coal.Capsule(0.2, 1.0), coal.Box(0.2, 0.4, 0.6))
        ]
    )
    assert cores.kinds.tolist() == [SEGMENT, SEGMENT, BOX]
    assert cores.radii.tolist() == [0.1, 0.2, 0.0]
    np.testing.assert_allclose(cores.halves, [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.1, 0.2, 0.3]])
