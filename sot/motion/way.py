"""Steps along a way that is given by the places where the body is to be, one foot after the other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sot.gravity import GRAVITY
from sot.motion.feet.contacts import Phase
from sot.motion.feet.footholds import LegReach
from sot.motion.feet.footwork import Foothold, Step
from sot.motion.feet.swing import FootPath, contact_phases, foot_paths
from sot.robots.robot import Robot
from sot.robots.size import leg_length

Array = np.ndarray

MAX_STEP = 0.18  # leg lengths, from one foot to where the other one lands beside or ahead of it
MAX_TURN = np.deg2rad(12.0)  # of a foot, from the other one's heading
STEP_HEIGHT = 0.09  # leg lengths
SWING_TIME, STANDING_TIME = 2.4, 1.2  # √(leg / g): of a step, and on both feet before the next one
WAITING_TIME = 4.8  # √(leg / g) on both feet at the start, at each stop and at the end


@dataclass(frozen=True)
class Footsteps:
    """Steps in order of time.

    Attributes:
        stands: foot -> its footholds, the first where it stands at the start.
        steps: from one foothold to the next.
        end: when both feet have stood at the end for as long as they are to [s].
        arrivals: when the last step to each stop has landed [s].
    """

    stands: dict[str, list[Foothold]]
    steps: list[Step]
    end: float
    arrivals: list[float]

    def feet_at(self, robot: Robot, knots: Array) -> tuple[tuple[Phase, ...], dict[str, FootPath]]:
        """Which feet of a robot stand where, and their paths at times (T,) from the start to the end [s]."""
        lifts = [STEP_HEIGHT * leg_length(robot)] * len(self.steps)
        phases = contact_phases(robot, self.stands, self.steps, float(knots[-1]))
        return phases, foot_paths(robot, self.stands, self.steps, lifts, LegReach.of(robot), knots)


@dataclass(frozen=True)
class Gait:
    """How a robot steps.

    Attributes:
        step: greatest way of the body in a step [leg lengths].
        swing, standing: times of a step, and on both feet before the next one [√(leg / g)].
    """

    step: float = MAX_STEP
    swing: float = SWING_TIME
    standing: float = STANDING_TIME


USUAL_GAIT = Gait()


def standing_footholds(robot: Robot) -> dict[str, Foothold]:
    """Where the feet stand at rest; headings count from there."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.rest)
    ankles = {foot: data.oMf[robot.point(foot.replace("foot", "ankle"))].translation for foot in robot.feet}
    return {foot: Foothold(float(place[0]), float(place[1]), 0.0) for foot, place in ankles.items()}


def footsteps_along(
    robot: Robot,
    stops: Sequence[Foothold],
    begin: float | None = None,
    gait: Gait = USUAL_GAIT,
    waits: Mapping[int, float] | None = None,
) -> Footsteps:
    """The footsteps by which a body goes from stop to stop, straight and turning evenly.

    Args:
        robot: who walks; it starts at rest, its body at the origin.
        stops: places and headings of the body, one after the other: where the origin of the rest posture comes to be.
        begin: time of the first step [s]; after the usual wait unless given.
        gait: how it steps.
        waits: index of a stop -> time on both feet there [√(leg / g)]; the usual wait unless given.
    """
    leg = leg_length(robot)
    unit = float(np.sqrt(leg / GRAVITY))
    stands, steps = {foot: [place] for foot, place in standing_footholds(robot).items()}, list[Step]()
    arrivals = list[float]()
    now, body = WAITING_TIME * unit if begin is None else begin, Foothold(0.0, 0.0, 0.0)
    for index, stop in enumerate(stops):
        feet = robot.feet if len(steps) % 2 else robot.feet[::-1]
        way, turn = np.hypot(stop.x - body.x, stop.y - body.y), abs(stop.heading - body.heading)
        count = max(int(np.ceil(way / (gait.step * leg) - 1e-9)), int(np.ceil(turn / MAX_TURN - 1e-9)))
        start = {foot: stands[foot][-1] for foot in feet}
        for k in range(count + 1):
            foot, share = feet[k % 2], min(k + 1, count) / count
            steps.append(Step(foot, now, now + gait.swing * unit))
            stands[foot].append(_moved(start[foot], body, stop, share))
            now += (gait.swing + gait.standing) * unit
        arrivals.append(steps[-1].land)
        now += ((waits or {}).get(index, WAITING_TIME) - gait.standing) * unit
        body = stop
    return Footsteps(stands, steps, now, arrivals)


def _moved(foot: Foothold, body: Foothold, stop: Foothold, share: float) -> Foothold:
    """Where a foot is when its body has gone a share of its way to a stop."""
    turn = share * (stop.heading - body.heading)
    ahead, aside = foot.x - body.x, foot.y - body.y
    return Foothold(
        body.x + share * (stop.x - body.x) + ahead * float(np.cos(turn)) - aside * float(np.sin(turn)),
        body.y + share * (stop.y - body.y) + ahead * float(np.sin(turn)) + aside * float(np.cos(turn)),
        foot.heading + turn,
    )
