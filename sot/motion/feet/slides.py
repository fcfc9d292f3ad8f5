"""Slides of a foot: when one may slide, found from the zero moment point, and its path; Ramos IV-C and Figure 8."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.errors import InputError
from sot.motion.feet.contacts import Phase
from sot.motion.feet.stance import LEAD_IN_TIME, TAIL_TIME
from sot.motion.feet.support import supports
from sot.motion.feet.swing import FootPath
from sot.robots.robot import Robot

Array = NDArray[np.float64]
SlideWay = tuple[float, float, float]

SLIDE_FORWARD: SlideWay = (0.085, 0.0, 0.0)
"""A way by default. Forward, friction pushes a bent leg onto the floor; outward or back it lifts it off."""
SLIDE_SPEED = 0.0075
"""Mean speed of a slide [m/s]: the faster, the less of the time does MuJoCo's floor carry it (docs/lessons.md)."""
SPEED_UP_TIME = 0.3
"""Time in which a sliding foot gets to its speed, and the same to stop [s]. Between, the speed is even: hops come with
speed, and a peak would have most."""
REST_TIME = 0.2
"""Time that a sliding foot rests before and after its way [s]."""


@dataclass(frozen=True)
class Slide:
    """A foot's way over the floor while the other one carries.

    Attributes:
        foot: which slides.
        start, end: of its contact's sliding [s].
        way: where to, from where it stands: forward and away from the other foot [m], turned outward [rad].
        zmp_excess: mean distance of the ZMP from where the other foot can hold it [m]; where it is 0, no balance needs
            to be planned anew.
    """

    foot: str
    start: float
    end: float
    way: SlideWay
    zmp_excess: float = 0.0


def slide_duration(way: SlideWay, robot: Robot) -> float:
    """The duration of a slide, by the sole's corner that goes farthest [s]."""
    reach = max(float(np.linalg.norm(robot.sole(foot)[:, :2], axis=1).max()) for foot in robot.feet)
    return 2.0 * REST_TIME + (float(np.hypot(way[0], way[1])) + reach * abs(way[2])) / SLIDE_SPEED


def find_slide(robot: Robot, phases: Sequence[Phase], zmp: Array, rate: float, way: SlideWay = SLIDE_FORWARD) -> Slide:
    """The slide that fits a motion best.

    A foot may slide while the ZMP lies wholly where the other one alone can hold it. If that is never long enough, the
    ZMP has to be brought there (`zmp_excess`): the stretch taken is that in which it is the least way off, on average.

    Args:
        robot: who moves.
        phases: its contacts; a slide lies where both feet stand, after the lead-in and before the rest at the end.
        zmp: (T, 2) from time zero on [m].
        rate: samples per second [Hz].
        way: of the slide.

    Raises:
        InputError: the motion has no room for it.
    """
    ticks = round(slide_duration(way, robot) * rate)
    first, last = round(LEAD_IN_TIME * rate), len(zmp) - round(TAIL_TIME * rate)
    costs = np.full((len(robot.feet), len(zmp)), np.inf)
    for phase in phases:
        if len(phase.feet) < len(robot.feet):
            continue
        begin, end = max(first, round(phase.start * rate)), min(last, round(phase.end * rate))
        if end - begin <= ticks:
            continue
        for k, foot in enumerate(robot.feet):
            total = np.concatenate([[0.0], np.cumsum(_zmp_excess(robot, phase, foot, zmp[begin:end]))])
            costs[k, begin : end - ticks + 1] = (total[ticks:] - total[:-ticks]) / ticks
    k, start = divmod(int(np.argmin(costs)), len(zmp))
    if not np.isfinite(costs[k, start]):
        raise InputError(
            f"the motion is too short for a slide: one takes {ticks / rate:.1f} s on both feet, after "
            f"{LEAD_IN_TIME:g} s and before the last {TAIL_TIME:g} s"
        )
    return Slide(robot.feet[k], start / rate, (start + ticks) / rate, way, float(costs[k, start]))


def phases_with_slides(phases: Sequence[Phase], slides: Sequence[Slide], robot: Robot) -> tuple[Phase, ...]:
    """The contact phases with some slides among them; afterwards the feet stand where they have come to."""
    for slide in slides:
        made: list[Phase] = []
        for phase in phases:
            if phase.end <= slide.start:
                made.append(phase)
                continue
            after = dict(phase.feet)
            if slide.foot in after:
                there = _poses_along_slide(after[slide.foot], slide, robot, np.ones(1))
                after[slide.foot] = pin.SE3(there.rotation[0], there.position[0])
            if phase.start < slide.end:
                alone = {foot: pose for foot, pose in phase.feet.items() if foot != slide.foot}
                made.append(replace(phase, end=slide.start))
                made.append(Phase(slide.start, slide.end, alone, (slide.foot,)))
            made.append(Phase(max(phase.start, slide.end), phase.end, after, phase.sliding))
        phases = made
    return tuple(phases)


def paths_with_slides(
    paths: Mapping[str, FootPath], slides: Sequence[Slide], robot: Robot, times: Array
) -> dict[str, FootPath]:
    """The paths of the feet with some slides among them, each from rest to rest, without acceleration there.

    Args:
        paths: at T knots; a foot that slides stands from its first slide on.
        slides: in order of time.
        robot: whose feet.
        times: (T,) of the knots [s].
    """
    made = dict(paths)
    for slide in slides:
        before = made[slide.foot]
        k = int(np.searchsorted(times, slide.start))
        here = pin.SE3(before.rotation[k], before.position[k])
        share = glide_share(times[k:] - slide.start - REST_TIME, slide.end - slide.start - 2.0 * REST_TIME)
        way = _poses_along_slide(here, slide, robot, share)
        made[slide.foot] = FootPath(
            np.concatenate([before.position[:k], way.position]),
            np.concatenate([before.rotation[:k], way.rotation]),
            before.free,
            before.yielding,
        )
    return made


def glide_share(t: Array, duration: float) -> Array:
    """The share (n,) of a slide's way at times (n,) since its start [s]: at an even speed but for SPEED_UP_TIME at the
    ends.

    The speed comes and goes as `ease`, of which this is the integral.
    """
    x = np.clip(np.stack([t, duration - t]) / SPEED_UP_TIME, 0.0, 1.0)
    come, gone = SPEED_UP_TIME * (2.5 * x**4 - 3.0 * x**5 + x**6)
    even = np.clip(t - SPEED_UP_TIME, 0.0, duration - 2.0 * SPEED_UP_TIME)
    return (come + even + 0.5 * SPEED_UP_TIME - gone) / (duration - SPEED_UP_TIME)


def _poses_along_slide(here: pin.SE3, slide: Slide, robot: Robot, share: Array) -> FootPath:
    """The poses of a foot at shares (n,) of its slide."""
    side = 1.0 if robot.feet.index(slide.foot) == 0 else -1.0
    forward, outward, turn = slide.way
    ahead = here.rotation[:2, 0] / np.linalg.norm(here.rotation[:2, 0])
    aside = side * np.array([-ahead[1], ahead[0]])
    position = np.tile(here.translation, (len(share), 1))
    position[:, :2] += share[:, None] * (forward * ahead + outward * aside)
    turns = np.array([pin.utils.rotate("z", side * turn * part) for part in share.tolist()])
    return FootPath(position, turns @ here.rotation, *np.zeros((2, len(share))))


def _zmp_excess(robot: Robot, phase: Phase, foot: str, zmp: Array) -> Array:
    """How far the ZMP (n, 2) is from the support of the other feet alone, (n,) [m]."""
    others = {other: pose for other, pose in phase.feet.items() if other != foot}
    (support,) = supports(robot, [Phase(0.0, 1.0, others, (foot,))])
    return np.maximum(-support.inset.margin(zmp), 0.0)
