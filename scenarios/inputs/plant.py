"""The plant as one asks for it on a command line: servos or torque motors, soft feet, sensors, and what is known."""

from math import inf, isfinite
from typing import Literal

from sim.drivers import PositionController
from sot.control.controller import Controller
from sot.errors import InputError
from sot.estimation import ContactFilter, Estimator
from sot.hardware.compliance import FootCompliance
from sot.hardware.hardware import Hardware
from sot.hardware.sensors import sensor_preset
from sot.hardware.servo import Servo
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.servo.stabiliser import DcmGains, Stabiliser
from sot.servo.stacks.catching_stack import CatchingStack
from sot.servo.stacks.integrated_stack import IntegratedStack

PLANTS = ("torque", "servo")
STEPPING = "dcm-steps"
STABILISERS = ("dcm", STEPPING, "dcm-adaptive", "sag", "open")
"""What a robot with servos does beside its plan: the divergent component is fed back and what the plan's loads deflect
is undone; the same, and it steps where feet that stay cannot bring that back; the same for feet whose compliance has to
be estimated; the latter alone; nothing."""
STATES = ("true", "estimated", "footholds")
"""What a controller is told: the simulated state, or what an estimator makes of readings, or of those and of where the
plan puts the feet."""


def parse_feet_compliance(text: str) -> FootCompliance:
    """Compliant feet from "KX,KY" or "KX,KY,KZ": stiffness about x (roll) and y (pitch) [N m/rad] and along z [N/m].

    Raises:
        InputError: anything else.
    """
    try:
        roll, pitch, *vertical = map(float, text.split(","))
    except ValueError:
        roll, pitch, vertical = inf, inf, []
    stiffnesses = (roll, pitch, *vertical)
    if len(stiffnesses) > 3 or not all(isfinite(value) and value > 0.0 for value in stiffnesses):
        raise InputError(
            f'--feet-compliance "{text}": give KX,KY or KX,KY,KZ, positive numbers, as in "2500,2500": '
            "roll and pitch [N m/rad], height [N/m]"
        )
    return FootCompliance(*stiffnesses)


def hardware_of(
    robot: Robot,
    plant: str,
    compliance: FootCompliance | None,
    state: str = "true",
    sensors: str = "ideal",
    seed: int = 0,
) -> Hardware:
    """The hardware of a robot on a plant; with sensors, by the name of a preset, where somebody reads them.

    Raises:
        InputError: no such plant, state or sensors.
    """
    if plant not in PLANTS:
        raise InputError(f"unknown plant '{plant}': choose one of {', '.join(PLANTS)}")
    if state not in STATES:
        raise InputError(f"unknown state '{state}': choose one of {', '.join(STATES)}")
    named = sensor_preset(sensors, seed)
    if plant == "torque" and state == "true":
        if sensors != "ideal":
            raise InputError(f"--sensors {sensors}: torques of the true state read none; add --state estimated")
        return Hardware(compliance=compliance)
    return Hardware(Servo.of(robot) if plant == "servo" else None, compliance, named)


def estimator_of(robot: Robot, hardware: Hardware, state: str) -> Estimator | None:
    """Who tells a controller the state of a robot with that hardware; None where it is told the true one."""
    if state == "true" or hardware.sensors is None:
        return None
    return ContactFilter(robot, hardware.sensors, hardware.compliance, footholds=state == "footholds")


def position_controller(
    name: str,
    motion: Motion,
    hardware: Hardware,
    period: float,
    stack: Controller | None = None,
) -> PositionController:
    """The controller of a robot with servos, by the name of what stabilises it.

    Args:
        name: one of `STABILISERS`.
        motion: the plan.
        hardware: of the robot.
        period: control period [s].
        stack: with its solver and schedule, whose accelerations lead the robot; the plan itself unless given.

    Raises:
        InputError: no such name.
    """
    if name not in STABILISERS:
        raise InputError(f"unknown stabiliser '{name}': choose one of {', '.join(STABILISERS)}")
    known: FootCompliance | Literal["estimated"] | None
    known = "estimated" if name == "dcm-adaptive" else hardware.compliance if name != "open" else None
    dcm = DcmGains() if name.startswith("dcm") else None
    servo = hardware.servo if name != "open" else None
    if name == STEPPING:
        assert stack is not None, "steps are a schedule's"
        return Stabiliser(motion, period, known, servo, dcm, catching=CatchingStack(stack, motion))
    sample = IntegratedStack(stack, motion.q[0], motion.v[0]).sample if stack is not None else None
    return Stabiliser(motion, period, known, servo, dcm, sample=sample)
