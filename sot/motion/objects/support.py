"""Where the centre of mass is to be over the supports: Otani (9), and (31)-(33) in a form that is right."""

import numpy as np

from sot.gravity import GRAVITY
from sot.polygon import Polygon

Array = np.ndarray


def support_centre(points: Array) -> Array:
    """h(E1) of Otani (9): the centre (2,) of the convex hull of contact points (n, 2) seen from above [m]."""
    return Polygon.hull(points).centre


def normalised_offsets(supports: Array, com: Array) -> Array:
    """Weights (n,) of sum 1 whose mean of the support points (n, 2) is the centre of mass (2,), nearest to equal ones.

    They take the place of Otani (31): the paper projects onto the lines from one support, chosen at will, to each of
    the others and adds the projections up, (32), which counts what two lines have in common twice. With three supports
    that are not on a line these weights are exact; with two they give the projection onto their line, as the paper's
    do; one support has all the weight.
    """
    middle = supports.mean(axis=0)
    # The rows of what is inverted add up to nothing over the supports, and so do the weights' differences from 1/n.
    weights: Array = 1.0 / len(supports) + np.linalg.pinv((supports - middle).T) @ (com - middle)
    return weights


def com_over_supports(human_supports: Array, human_com: Array, robot_supports: Array) -> Array:
    """ψ of Otani (33): a robot's centre of mass (2,) among its supports (n, 2), as a human's is among its own [m]."""
    place: Array = normalised_offsets(human_supports, human_com) @ robot_supports
    return place


def com_shift_of_hands(forces: Array, points: Array, middle: Array, mass: float) -> Array:
    """How far the centre of mass has to be off so that the feet's zero-moment point stays: (Σ moment)/(m g), (2,) [m].

    Args:
        forces: On the robot's hands, world (n, 3) [N].
        points: Where they act (n, 3) [m].
        middle: Of the feet, on the floor (3,) [m].
        mass: Of the robot and what it carries [kg].
    """
    moment = np.cross(points - middle, forces).sum(axis=0)
    # The weight's moment about the middle is m g (-(c_y), c_x): both together are to be none.
    return np.array([-moment[1], moment[0]]) / (mass * GRAVITY)
