"""Parts of a robot that touch or nearly touch at rest."""

from collections.abc import Iterator, Sequence

import mujoco

from scenarios.robots.findings import Finding, Severity
from sot.robots.guess.posed_model import PosedModel
from sot.robots.pairs import LIMBS, TOUCHING_DISTANCE
from sot.robots.robot import Robot

NEAR_DISTANCE = 0.02  # m, that is little room at rest
NEIGHBOUR_JOINTS = 3  # links with no more joints between them are neighbours, about a hip or a shoulder
NAMED_PAIRS = 6  # that are named at most


def clearance_findings(robot: Robot, posed: PosedModel) -> Iterator[Finding]:
    """Links of different limbs, or of a limb and the trunk, that are near each other and no neighbours.

    Args:
        robot: the robot.
        posed: its physics, at rest.
    """
    limb = {}
    for group in LIMBS:
        for k in robot.groups[group]:
            joint = mujoco.mj_name2id(posed.model, mujoco.mjtObj.mjOBJ_JOINT, robot.joints[k])
            limb[posed.link_of(joint)] = group
    near = []
    for k, first in enumerate(posed.links):
        for second in posed.links[:k]:
            own = limb.get(first, "trunk"), limb.get(second, "trunk")
            if own[0] == own[1] or len(posed.joints_between(first, second)) <= NEIGHBOUR_JOINTS:
                continue
            apart = posed.distance([first], [second], NEAR_DISTANCE)
            if apart < NEAR_DISTANCE:
                near.append((apart, f"{posed.name(second)} and {posed.name(first)} {1e3 * apart:.0f} mm"))
    near.sort()
    touching = [words for apart, words in near if apart < TOUCHING_DISTANCE]
    close = [words for apart, words in near if apart >= TOUCHING_DISTANCE]
    remedy = "hold arms and legs farther apart in 'rest'"
    if touching:
        what = "links touch at rest: nothing keeps them apart in the dance"
        yield Finding(Severity.WARNS, what, _some(touching), f"{remedy}, unless they are made to touch")
    if close:
        what = f"links are nearer than {1e3 * NEAR_DISTANCE:.0f} mm at rest"
        yield Finding(Severity.NOTES, what, _some(close), remedy)


def _some(pairs: Sequence[str]) -> str:
    more = f" and {len(pairs) - NAMED_PAIRS} more" if len(pairs) > NAMED_PAIRS else ""
    return ", ".join(pairs[:NAMED_PAIRS]) + more
