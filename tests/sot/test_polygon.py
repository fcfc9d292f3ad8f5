"""Convex polygons against a quadratic program and against plain geometry."""

import numpy as np
import pytest
import quadprog

from sot.polygon import Polygon

RECTANGLE = np.array([[0.1, 0.2], [-0.1, 0.2], [0.1, -0.2], [-0.1, -0.2]])


def projection(polygon, point):
    """The nearest point of the polygon by a quadratic program; None if the polygon is empty."""
    try:
        return quadprog.solve_qp(np.eye(2), point, -polygon.normals.T, -polygon.offsets)[0]
    except ValueError:
        return None


def random_polygons(seed, count):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        polygon = Polygon.hull(rng.uniform(-0.2, 0.2, (rng.integers(3, 9), 2)) * [1.0, rng.uniform(0.2, 2.0)])
        yield polygon if rng.random() < 0.5 else polygon.shrunk(0.01, 0.01)


def test_nearest_is_the_projection():
    rng, outside = np.random.default_rng(0), 0
    for polygon in random_polygons(1, 100):
        for point in rng.uniform(-0.5, 0.5, (5, 2)):
            expected = projection(polygon, point)
            if expected is not None:
                np.testing.assert_allclose(polygon.nearest_point(point), expected, atol=1e-9)
                outside += polygon.margin(point) < 0.0
    assert outside > 200


def test_a_point_inside_stays():
    polygon = Polygon.hull(RECTANGLE)
    for point in ([0.0, 0.0], [0.0999, -0.1999]):
        np.testing.assert_array_equal(polygon.nearest_point(np.array(point)), point)
    np.testing.assert_allclose(polygon.nearest_point(np.array([0.1, 0.2])), [0.1, 0.2], atol=1e-12)


def test_nearest_in_an_empty_polygon_is_the_point():
    empty = Polygon.hull(RECTANGLE).shrunk(0.11, 0.0)
    np.testing.assert_array_equal(empty.nearest_point(np.array([0.5, 0.5])), [0.5, 0.5])


def test_hull_has_one_edge_a_side_whatever_points_lie_on_it():
    crowded = np.vstack([RECTANGLE, 0.5 * (RECTANGLE + RECTANGLE[::-1]), RECTANGLE.mean(axis=0), RECTANGLE * [1, 0.5]])
    polygon = Polygon.hull(crowded)
    assert len(polygon.normals) == 4
    np.testing.assert_allclose(np.linalg.norm(polygon.normals, axis=1), 1.0)
    assert polygon.margin(crowded).min() == pytest.approx(0.0, abs=1e-12)


def test_margin_is_the_distance_to_the_nearest_edge():
    polygon = Polygon.hull(RECTANGLE)
    points = np.array([[0.0, 0.0], [0.07, 0.0], [0.0, -0.195], [0.13, 0.0], [0.1, 0.0]])
    np.testing.assert_allclose(polygon.margin(points), [0.1, 0.03, 0.005, -0.03, 0.0], atol=1e-12)
    assert polygon.margin(points.reshape(5, 1, 2)).shape == (5, 1)


def test_margin_grows_by_what_a_polygon_shrinks():
    rng = np.random.default_rng(2)
    polygon = Polygon.hull(rng.uniform(-0.2, 0.2, (8, 2)))
    points = rng.uniform(-0.3, 0.3, (20, 2))
    np.testing.assert_allclose(polygon.margin(points) - polygon.shrunk(0.02, 0.02).margin(points), 0.02)


def test_shrinking_moves_each_edge_by_its_axis():
    shrunk = Polygon.hull(RECTANGLE).shrunk(0.03, 0.05)
    corners = np.array([[0.07, 0.15], [0.07, -0.15], [-0.07, 0.15], [-0.07, -0.15]])
    np.testing.assert_allclose(shrunk.margin(corners), 0.0, atol=1e-12)
    assert shrunk.margin(np.zeros(2)) == pytest.approx(0.07)


def test_vertices_go_round_the_corners():
    corners = Polygon.hull(RECTANGLE).shrunk(0.03, 0.05).vertices
    assert np.array(sorted(corners.tolist())) == pytest.approx(
        np.array([[-0.07, -0.15], [-0.07, 0.15], [0.07, -0.15], [0.07, 0.15]])
    )
    (x, y), (next_x, next_y) = corners.T, np.roll(corners, -1, axis=0).T
    assert 0.5 * np.sum(x * next_y - next_x * y) == pytest.approx(0.14 * 0.30)


def test_vertices_span_the_polygon():
    for polygon in random_polygons(3, 50):
        corners = polygon.vertices
        if len(corners) > 2:
            same = Polygon.hull(corners)
            points = np.random.default_rng(4).uniform(-0.3, 0.3, (50, 2))
            np.testing.assert_array_equal(same.margin(points) > 1e-6, polygon.margin(points) > 1e-6)


def test_an_empty_polygon_has_no_vertices():
    assert Polygon.hull(RECTANGLE).shrunk(0.11, 0.0).vertices.shape == (0, 2)


@pytest.mark.parametrize("noise", [0.0, 1e-17, 1e-13, 1e-10, 1e-8])
def test_hull_of_points_on_common_lines_whatever_rounding_does_to_them(noise):
    """The corners of feet side by side: many of them on one edge, before and behind each other by chance."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        points = rng.uniform(-0.2, 0.2, (rng.integers(4, 14), 2)).round(1)
        if np.linalg.matrix_rank(points - points[0], tol=1e-6) < 2:
            continue
        points += noise * rng.normal(size=points.shape)
        polygon = Polygon.hull(points)
        distances = polygon.offsets[:, None] - polygon.normals @ points.T
        assert distances.min() > -5e-9, "a point outside"
        assert distances.min(axis=1).max() < 5e-9, "an edge that touches nothing"
