"""Whether soles lie flat on the floor, and are what of the feet touches it in physics."""

from collections.abc import Iterator

import mujoco
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from scenarios.robots.findings import Finding, Severity
from sim.convert import joint_order, state_to_mujoco
from sim.scene import build_model
from sot.robots.guess.tree import Tree
from sot.robots.robot import Robot

Array = NDArray[np.float64]

FLAT = 1e-3  # m, by which corners of a sole, and it and what touches the floor, may differ
FAR_OFF = 1e-2  # m, by which they may not
TIMESTEP, FRICTION = 1e-3, 0.7  # of the physics that is looked at


def sole_findings(robot: Robot) -> Iterator[Finding]:
    """Soles that are not flat, larger or smaller than the foot, and what else is on the floor at rest."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    soles = {foot: np.array([data.oMf[robot.point(foot)].act(c) for c in robot.sole(foot)]) for foot in robot.feet}
    tree = at_rest(robot)
    for foot, corners in soles.items():
        where = f"soles.{foot}"
        spread = float(np.ptp(corners[:, 2]))
        if spread > FLAT:
            what = f"the sole is not flat at rest: its corners differ by {1e3 * spread:.1f} mm in height"
            yield Finding(Severity.STOPS, what, where, "correct the ankle in 'rest', or the corners")
        link = _link(robot, tree, foot)
        yield from _against_geometry(tree, link, corners, where)
    yield from _others_on_floor(robot, tree)


def at_rest(robot: Robot) -> Tree:
    """The robot as physics has it, at rest."""
    tree = Tree(build_model(robot, TIMESTEP, FRICTION))
    names = [tree.joint_name(j) for j in tree.joints]
    qpos, _ = state_to_mujoco(robot.rest, np.zeros(robot.nv), joint_order(robot.joints, names))
    tree.place(qpos)
    return tree


def _link(robot: Robot, tree: Tree, foot: str) -> int:
    joint = robot.model.names[robot.model.frames[robot.point(foot)].parentJoint]
    return tree.link_of(mujoco.mj_name2id(tree.model, mujoco.mjtObj.mjOBJ_JOINT, joint))


def _against_geometry(tree: Tree, link: int, corners: Array, where: str) -> Iterator[Finding]:
    points = tree.surface(tree.touching([link]))
    if not len(points):
        yield Finding(Severity.STOPS, "nothing of the foot can touch the floor", where, "give the link a shape")
        return
    floor = float(points[:, 2].min())
    apart = floor - float(corners[:, 2].min())
    if abs(apart) > FLAT:
        side = "above" if apart > 0 else "below"
        what = f"what touches the floor is {1e3 * abs(apart):.1f} mm {side} the sole"
        severity = Severity.STOPS if abs(apart) > FAR_OFF else Severity.WARNS
        yield Finding(severity, what, where, f"put the foot's frame at {1e3 * apart:+.1f} mm, on the lowest point")
    low = points[points[:, 2] < floor + FLAT][:, :2]
    beyond = max(_outside(low, corner[:2]) for corner in corners)
    if beyond > FLAT:
        severity = Severity.STOPS if beyond > FAR_OFF else Severity.WARNS
        what = f"the sole is too large: it reaches {1e3 * beyond:.1f} mm beyond what touches the floor"
        yield Finding(severity, what, where, "take the corners back: the robot would tip where it counts on a sole")
    short = max(_outside(corners[:, :2], point) for point in low)
    if short > FAR_OFF:
        what = f"the sole is {1e3 * short:.0f} mm smaller than what touches the floor"
        yield Finding(Severity.NOTES, what, where, "larger corners would give balance more room")


def _outside(points: Array, place: Array) -> float:
    """How far a place (2,) is outside the convex hull of points (n, 2) [m]."""
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        return float(np.linalg.norm(points - place, axis=1).min())
    return max(0.0, float((hull.equations @ np.append(place, 1.0)).max()))


def _others_on_floor(robot: Robot, tree: Tree) -> Iterator[Finding]:
    feet = {_link(robot, tree, foot) for foot in robot.feet}
    for link in tree.links:
        points = tree.surface(tree.touching([link]))
        if link not in feet and len(points) and points[:, 2].min() < FLAT:
            what = f"a link that is no foot is {1e3 * points[:, 2].min():.1f} mm above the floor at rest"
            remedy = "its shape is too large, or the rest posture too low: it will meet the floor"
            yield Finding(Severity.STOPS, what, tree.name(link), remedy)
