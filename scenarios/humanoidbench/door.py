"""`sot run humanoidbench door`: a door with a lever is unlatched, pushed open and walked through."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pinocchio as pin

from scenarios.humanoidbench.size import scene_scale
from scenarios.humanoidbench.stack import led_hands_stack
from scenarios.inputs.stack_file import Composition
from scenarios.replay import Dance, ProgressCallback, Replay, run_motion
from sim.reporting.objects import object_figures
from sot.behaviours.stepping import SteppingSchedule
from sot.control.contact import Contact
from sot.control.load import KnownWrench
from sot.control.stack import Stack
from sot.motion.carrying.door_layout import DoorLayout
from sot.motion.carrying.pass_door import DoorPlan, pass_door
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.surface import Surface
from sot.robots.system import System
from sot.robots.things.thing import Thing

Array = np.ndarray

DOOR = "door"
"""Name of the door."""
AHEAD_M = 0.8
"""Where the leaf's middle is [m]."""
HINGE_M, FACE_M = (0.05, 0.5), 0.12
"""Place of the hinge's axis from there, and distance of the leaf's near face from the axis [m]."""
LEVER_M, BAR_M, BAR_RADIUS_M = (-0.141, -0.4, 1.2), 0.2, 0.02
"""Place of the lever's axis from there, where the bar is; length and radius of the bar [m]."""
GRIP_M = 0.86
"""Distance from the axis, along the leaf, at which it is pushed [m]."""
PRESS_SHARE = 0.6
"""Share of the bar's length at which it is pressed."""
FRAME_M = 0.12
"""Half the depth of the frame [m]."""
PRESSED_RAD, UNLATCHED_RAD, OPENED_RAD = 0.9, 0.33, 1.1
"""Angles: of the lever when it is down, of the door when the bolt is within the frame, and to which it is opened."""
LEVER_REACHED_RAD, HINGE_REACHED_RAD, PAST_REACHED_M = 0.75, 1.0, 0.2
"""What has to be reached: angles of lever and hinge, and the waist's way past the frame."""
NOISE_M = 0.003
"""Standard deviation of where the door stands, with a seed, in each direction [m]: the benchmark's stands still."""


@dataclass(frozen=True)
class DoorScene:
    """Where the door stands, in the robot's size.

    Attributes:
        scale: Of its lengths.
        offset: By how much it is off its place (2,) [m].
    """

    scale: float
    offset: Array

    @staticmethod
    def of(robot: Robot, seed: int) -> "DoorScene":
        """The scene of a seed."""
        return DoorScene(scene_scale(robot), NOISE_M * np.random.default_rng(seed).standard_normal(2))

    def thing(self, offset: bool) -> Thing:
        """The door, where it is told or where it is."""
        x, y = self.offset if offset else np.zeros(2)
        return Thing.load("latched_door", DOOR, (self.scale * AHEAD_M + x, y, 0.0), size=[self.scale] * 3)

    def told(self) -> Thing:
        """The door as the controller knows it, without its springs: what they do is told as forces on the hands.

        No contact is made with it: with springs it would seem to fly against the hands.
        """
        return replace(self.thing(offset=False), stiffness=np.zeros(2))

    def layout(self) -> DoorLayout:
        """The door as the robot is told of it."""
        scale, door = self.scale, self.thing(offset=False)
        x, y = HINGE_M
        return DoorLayout(
            hinge=scale * np.array([AHEAD_M + x, y]),
            face=scale * FACE_M,
            grip=scale * GRIP_M,
            lever=scale * np.add(LEVER_M, [AHEAD_M, 0.0, 0.0]),
            press=scale * PRESS_SHARE * BAR_M,
            bar=scale * BAR_RADIUS_M,
            stiffness=float(door.stiffness[0]),
            inertia=float(pin.crba(door.model, door.model.createData(), pin.neutral(door.model))[0, 0]),
            lever_stiffness=float(door.stiffness[1]),
            pressed=PRESSED_RAD,
            unlatched=UNLATCHED_RAD,
            opened=OPENED_RAD,
            exit=scale * (AHEAD_M + FRAME_M) + PAST_REACHED_M,
        )


def door_stack(system: System, plan: DoorPlan) -> Stack:
    """The stack of a robot whose hands are led in the world, and which is told the forces on them.

    The contacts of hands and door are never made: they say what is not kept apart.
    """
    robot, motion = system.robot, plan.motion
    surfaces = [robot.surface(own) for own in plan.forces]
    touches = [Contact(own, system.surface(f"{DOOR}/{other}")) for own in surfaces for other in ("front", "bar")]
    for touch in touches:
        touch.mode, touch.load = "off", 0.0
    hands = {own.point: motion.pose(own.point) for own in surfaces if own.point is not None}
    loads = [_told_force(own, plan) for own in surfaces]
    return led_hands_stack(system, motion, hands, touches, loads)


def _told_force(surface: Surface, plan: DoorPlan) -> KnownWrench:
    """The force on a hand's surface as the plan has it."""
    assert surface.point is not None
    path, arm = plan.motion.pose(surface.point), surface.placement.translation
    columns = np.hstack([plan.forces[surface.name], plan.touches[surface.name]]).T

    def wrench(t: float) -> Array:
        force, touch = np.split(np.array([np.interp(t, plan.knots, column) for column in columns]), 2)
        return np.concatenate([force, np.cross(path(t).rotation @ arm + touch, force)])

    return KnownWrench(surface.point, wrench)


def perform(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Dance, DoorScene]:
    """Plan and run; nothing is written."""
    robot = Robot.load(request.robot)
    tell("planning", None)
    scene = DoorScene.of(robot, seed)
    plan = pass_door(robot, scene.layout(), request.rate)
    system = System(robot, [scene.told()])

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(door_stack(system, plan), SteppingSchedule(robot, motion.phases))

    danced = run_motion(request, compose, plan.motion, None, tell, system=system, things=[scene.thing(offset=True)])
    return danced, scene


def figures(danced: Dance, scene: DoorScene) -> dict[str, Any]:
    """What became of door and robot."""
    assert danced.system is not None
    log, robot = danced.run.log.trimmed(), danced.system.robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, log.q[-1])
    frame = scene.scale * (AHEAD_M + FRAME_M) + scene.offset[0]
    past = float(data.oMf[robot.point("waist")].translation[0] - frame)
    hinge, lever = log.thing_q.max(axis=0).tolist()
    own = {
        "lever_max_rad": lever,
        "hinge_max_rad": hinge,
        "hinge_end_rad": float(log.thing_q[-1, 0]),
        "waist_past_frame_m": past,
        "reached": lever >= LEVER_REACHED_RAD
        and hinge >= HINGE_REACHED_RAD
        and past >= PAST_REACHED_M
        and danced.run.fell_at_s is None,
    }
    return {"objects": object_figures(log, danced.system), "humanoidbench": own}


def scene_run(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Dance, dict[str, Any]]:
    """Plan and run the scene of a seed: the run, and its figures."""
    done, scene = perform(request, seed, tell)
    return done, figures(done, scene)


def sentence(own: dict[str, Any]) -> str:
    """What became of it, for a reader."""
    return (
        f"lever turned to {own['lever_max_rad']:.2f} rad, door to {own['hinge_max_rad']:.2f} rad,"
        f" waist {own['waist_past_frame_m']:.2f} m past the frame"
    )
