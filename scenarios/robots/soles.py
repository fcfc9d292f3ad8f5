"""What of a robot is on the floor at rest beside its soles, and how much of its feet the soles leave out."""

from collections.abc import Iterator

import numpy as np

from scenarios.robots.findings import Finding, Severity
from sim.convert import state_to_mujoco
from sim.scene import build_model
from sot.robots.guess.posed_model import PosedModel
from sot.robots.robot import Robot

FLOOR_TOLERANCE = 1e-3  # m, below which something is on the floor
SMALLER_SHARE = 0.1  # share of a sole's length that is told when corners leave it out
TIMESTEP, FRICTION = 1e-3, 0.7  # of the physics that is looked at


def at_rest(robot: Robot) -> PosedModel:
    """The robot as physics has it, at rest.

    Raises:
        InputError: MuJoCo cannot compile it.
    """
    posed = PosedModel(build_model(robot, TIMESTEP, FRICTION))
    posed.place(state_to_mujoco(robot.rest, np.zeros(robot.nv))[0])
    return posed


def sole_findings(robot: Robot, posed: PosedModel) -> Iterator[Finding]:
    """Soles that are smaller than what touches the floor, and links that touch it but are no feet.

    Args:
        robot: the robot.
        posed: its physics, at rest.
    """
    feet = {}
    for foot in robot.feet:
        site = posed.model.site(foot)
        link = int(posed.model.body_weldid[int(site.bodyid[0])])
        feet[link] = foot
        corners = posed.data.site_xpos[site.id][:2] + robot.sole(foot)[:, :2]
        points = posed.surface(posed.touching([link]))
        low = points[points[:, 2] < points[:, 2].min() + FLOOR_TOLERANCE][:, :2]
        short = max((corners.min(axis=0) - low.min(axis=0)).max(), (low.max(axis=0) - corners.max(axis=0)).max())
        if short > SMALLER_SHARE * np.ptp(corners[:, 0]):
            what = f"the sole is {1e3 * short:.0f} mm smaller than what touches the floor"
            yield Finding(Severity.NOTES, what, f"soles.{foot}", "larger corners would give balance more room")
    for link in posed.links:
        points = posed.surface(posed.touching([link]))
        if link not in feet and len(points) and points[:, 2].min() < FLOOR_TOLERANCE:
            what = f"a link that is no foot is {1e3 * points[:, 2].min():.1f} mm above the floor at rest"
            remedy = "its shape is too large, or the rest posture too low: it will meet the floor"
            yield Finding(Severity.STOPS, what, posed.name(link), remedy)
