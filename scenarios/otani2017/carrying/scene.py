"""The stands and the box of a carrying, and the contacts and paths that are planned for them."""

import numpy as np
import pinocchio as pin

from scenarios.otani2017.scene import ObjectOptions
from sot.motion.carrying.carry import STANDOFF, CarryPlan
from sot.motion.objects.com_path import PlacePath
from sot.motion.objects.events import ROBOT, WORLD, ContactEvent, ContactPlan, SurfaceName, SurfacePair
from sot.motion.objects.pose_path import PosePath
from sot.motion.objects.retarget import OTHER_STANDOFF, RobotDemonstration, Target, named_surfaces
from sot.robots.size import leg_length
from sot.robots.system import System
from sot.robots.things.thing import Thing
from sot.smooth import minimum_jerk

STAND_SHARE = 1.0, 0.82
"""Size of both stands' tops over the box's, as who stands before one sees it: palms hang down beside them."""
BOX, START, GOAL = "box", "start", "goal"
"""Names of the box and of the stands."""


def carry_things(
    plan: CarryPlan, options: ObjectOptions, offset: pin.SE3 | None = None, stands: bool = True
) -> list[Thing]:
    """The box where it is taken from, and the stands under it there and where it is set down, if it is on any."""
    things = []
    for name, place in ((START, plan.box[0]), (GOAL, plan.box[-1])) if stands else ():
        at, turn = place.translation, pin.utils.rotate("z", float(pin.log3(place.rotation)[2]))
        depth, width = (share * length for share, length in zip(STAND_SHARE, plan.size, strict=False))
        size, foot = (depth, width, float(at[2]) - 0.5 * plan.size[2]), pin.SE3(turn, np.array([at[0], at[1], 0.0]))
        things.append(Thing.load("stand", name, foot, size=size, friction=options.friction))
    place = plan.box[0] if offset is None else plan.box[0] * offset
    return [*things, Thing.load("box", BOX, place, mass=options.mass, size=list(plan.size), friction=options.friction)]


def carry_demonstration(plan: CarryPlan, system: System) -> RobotDemonstration:
    """The contacts and paths of a planned carrying, from stand to stand if the system has some, else on the floor."""
    robot, motion = system.robot, plan.motion
    surfaces = dict(named_surfaces(system, {f"{side}_hand": f"{side}_palm" for side in ("left", "right")}))
    feet = [SurfacePair(SurfaceName(ROBOT, foot), SurfaceName(WORLD, "floor")) for foot in robot.feet]
    stands = (START, GOAL) if SurfaceName(WORLD, GOAL) in surfaces else ("floor", "floor")
    on_start, on_goal = (SurfacePair(SurfaceName(BOX, "bottom"), SurfaceName(WORLD, name)) for name in stands)
    grips = [SurfacePair(SurfaceName(ROBOT, f"{side}_hand"), SurfaceName(BOX, side)) for side in ("left", "right")]
    events = [
        *(ContactEvent(plan.gripped, "make", pair) for pair in grips),
        ContactEvent(plan.lifted, "break", on_start),
        ContactEvent(plan.placed, "make", on_goal),
        *(ContactEvent(plan.released, "break", pair) for pair in grips),
    ]
    standoff = OTHER_STANDOFF * leg_length(robot)
    targets, links = {}, {}
    for event, pair in zip(events[:2], grips, strict=True):
        point = surfaces[pair.first].point
        assert point is not None
        normal = surfaces[pair.second].placement.rotation[:, 2]
        targets[event] = Target(point, BOX, plan.hands[point], normal, STANDOFF * leg_length(robot))
        track = motion.track(point)
        links[point] = PosePath(motion.rate, track)
    targets[events[3]] = Target(BOX, None, plan.box[-1], np.array([0.0, 0.0, 1.0]), standoff)
    position = np.array([place.translation for place in plan.box])
    position[:, 2] += standoff * minimum_jerk((plan.knots - plan.arrived) / (plan.placed - plan.arrived))
    path = PosePath.through(plan.knots, position, np.array([place.rotation for place in plan.box]), motion.rate)
    com = PlacePath(motion.rate, motion.com[:, :2], motion.com_velocity[:, :2], motion.com_acceleration[:, :2])
    return RobotDemonstration(
        system,
        motion,
        ContactPlan((*feet, on_start), tuple(events)),
        surfaces,
        links,
        {BOX: path},
        targets,
        {frozenset(robot.feet): com},
    )
