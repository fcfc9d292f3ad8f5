"""`sot run otani cart`: a cart pushed ahead with both hands, on the robot's own steps."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from scenarios.inputs.stack_file import Composition
from scenarios.otani2017.carrying.stack import carry_stack
from scenarios.otani2017.figures import manipulation_figures, object_report, tick_medians
from scenarios.otani2017.handling_stack import contacts_of
from scenarios.replay import Dance, ProgressCallback, Replay, check_writable, make_solver, run_motion, write_outputs
from sim.recording.things import HandledThings
from sim.reporting import report
from sot.behaviours.manipulation.walking import WalkingManipulation
from sot.control.load import KnownWrench
from sot.motion.carrying.push import PushPlan, push
from sot.motion.objects.com_path import PlacePath
from sot.motion.objects.events import ROBOT, WORLD, ContactEvent, ContactPlan, SurfaceName, SurfacePair
from sot.motion.objects.pose_path import PosePath
from sot.motion.objects.retarget import HAND_STANDOFF, RobotDemonstration, Target, named_surfaces
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.system import System
from sot.robots.things.thing import Thing

WAY_M, SPEED_M_S = 2.0, 0.3
"""How far the cart is pushed, and how fast."""
MAX_HAND_SHARE = 0.7
"""Greatest share of the drag that a hand may press with: what keeps the trunk from turning would leave the other hand
without force, and it would slip."""
CART = "cart"
"""Name of the cart."""


@dataclass(frozen=True)
class Pushing:
    """A cart that is pushed: of its model's mass, against its model's drag."""

    takes_clip: ClassVar[bool] = False


@dataclass(frozen=True)
class Pushed:
    """A cart was pushed, or not.

    Attributes:
        danced: The run.
        schedule: Of the run.
        system: The robot and the cart as they are simulated.
        plan: What was planned.
    """

    danced: Dance
    schedule: WalkingManipulation
    system: System
    plan: PushPlan


def run(request: Replay, pushing: Pushing, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Plan, push, record and report.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    done = perform(request, tell)
    return write_outputs(done.danced, out, tell, report.rounded(cart_figures(done)))


def perform(request: Replay, tell: ProgressCallback) -> Pushed:
    """Plan the pushing of a cart and run it; nothing is written.

    The controller knows the drag as a wrench on a cart that rolls freely: at rest no drag could be told from its speed.
    """
    robot = Robot.load(request.robot)
    tell("planning", None)
    drag = float(Thing.load("cart").friction[0])
    plan = push(robot, WAY_M, SPEED_M_S, drag, request.rate)
    cart = Thing.load("cart", CART, (plan.wall, 0.0, 0.0))
    system = System(robot, [replace(cart, friction=np.zeros(1))])
    demonstration = cart_demonstration(plan, system)
    contacts = contacts_of(demonstration)
    for pair, contact in contacts.items():
        if pair.kind == "robot-thing":
            contact.most = MAX_HAND_SHARE * drag
    schedule = WalkingManipulation(demonstration, contacts)

    def known_drag(t: float) -> np.ndarray:
        return np.array([-np.interp(schedule.clock.time, plan.knots, plan.force), 0.0, 0.0])

    def compose(robot: Robot, motion: Motion) -> Composition:
        stack = carry_stack(demonstration, contacts, schedule)
        stack.add_load(KnownWrench(CART, known_drag))
        return Composition(stack, schedule)

    named = replace(request, clip="cart")
    danced = run_motion(named, compose, demonstration.motion, None, tell, system=system, things=[cart])
    played = schedule.played()
    danced.run.log.zmp_planned[: len(played.zmp)] = played.zmp  # the run knew the motion only as it is without waits
    assert danced.system is not None
    handled = HandledThings(schedule.history, schedule.played_times())
    return Pushed(replace(danced, motion=played, handled=handled), schedule, danced.system, plan)


def cart_demonstration(plan: PushPlan, system: System) -> RobotDemonstration:
    """The contacts and paths of a planned pushing."""
    robot, motion = system.robot, plan.motion
    surfaces = dict(named_surfaces(system, {f"{side}_hand": f"{side}_hand_end" for side in ("left", "right")}))
    feet = [SurfacePair(SurfaceName(ROBOT, foot), SurfaceName(WORLD, "floor")) for foot in robot.feet]
    grips = [SurfacePair(SurfaceName(ROBOT, f"{side}_hand"), SurfaceName(CART, "wall")) for side in ("left", "right")]
    events = [ContactEvent(plan.pressed, "make", pair) for pair in grips]
    targets, links = {}, {}
    for event, pair in zip(events, grips, strict=True):
        point = surfaces[pair.first].point
        assert point is not None
        standoff = HAND_STANDOFF * leg_length(robot)
        targets[event] = Target(point, CART, plan.hands[point], np.array([-1.0, 0.0, 0.0]), standoff)
        links[point] = PosePath(motion.rate, motion.track(point))
    position = np.column_stack([plan.wall + plan.way, np.zeros((len(plan.way), 2))])
    path = PosePath.through(plan.knots, position, np.tile(np.eye(3), (len(position), 1, 1)), motion.rate)
    com = PlacePath(motion.rate, motion.com[:, :2], motion.com_velocity[:, :2], motion.com_acceleration[:, :2])
    events += [ContactEvent(plan.released, "break", pair) for pair in grips]
    contacts = ContactPlan(tuple(feet), tuple(events))
    supports = {frozenset(robot.feet): com}
    return RobotDemonstration(system, motion, contacts, surfaces, links, {CART: path}, targets, supports)


def cart_figures(done: Pushed) -> dict[str, Any]:
    """What became of a cart that was pushed."""
    log, schedule, plan = done.danced.run.log.trimmed(), done.schedule, done.plan
    clock, start = schedule.played_times(), done.system.coordinates[CART].start - done.system.robot.nq
    way = log.thing_q[:, start] - log.thing_q[0, start]
    wanted = np.interp(clock, plan.knots, plan.way)
    on = (wanted > 0.25 * WAY_M) & (wanted < 0.75 * WAY_M)
    hands = [k for k, name in enumerate(log.contact_names) if name.endswith(f"on {CART}/wall")]
    force = np.nan_to_num(log.contact_normal[:, hands]).sum(axis=1)
    return {
        "objects": object_report(log, done.system, schedule.demonstration),
        "tick_median_us": tick_medians(log, schedule.history),
        "manipulation": manipulation_figures(schedule),
        "cart": {
            "pushed_m": float(way[-1]),
            "off_way_max_m": float(np.abs(way - wanted).max()),
            "speed_mean_m_s": float(log.thing_v[on, start].mean()) if on.any() else None,
            "hands_mean_n": float(force[on].mean()) if on.any() else None,
            "hands_max_n": float(force.max()),
            "steps": sum(len(phase.feet) == 1 for phase in plan.motion.phases),
        },
    }


def sentence(figures: dict[str, Any]) -> str:
    """What became of the cart, for a reader."""
    speed = "-" if figures["speed_mean_m_s"] is None else f"{figures['speed_mean_m_s']:.2f}"
    hands = "-" if figures["hands_mean_n"] is None else f"{figures['hands_mean_n']:.0f}"
    return (
        f"pushed {figures['pushed_m']:.2f} m at {speed} m/s in {figures['steps']} steps with {hands} N in the mean;"
        f" the cart up to {1e3 * figures['off_way_max_m']:.0f} mm off its planned way"
    )
