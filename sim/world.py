"""MuJoCo with a robot on a floor: torques in, state and contact forces out. It never helps the robot."""

from collections import deque
from collections.abc import Collection, Iterable, Sequence
from math import ceil

import mujoco
import numpy as np

from sim.hardware.sensor_suite import SensorSuite
from sim.hardware.servo_drive import ServoDrive
from sim.hardware.soles import Soles
from sim.mismatch import NO_MISMATCH, Mismatch
from sim.own_scene import Scene
from sim.push import Push, Pusher
from sim.robot_state import RobotState, ThingState
from sim.scene import build_model
from sim.sensors import FloorSensors, SelfDistance
from sim.touch import Touch, TouchSensors
from sot.control.contact import Contact
from sot.control.load import Carried
from sot.hardware.hardware import TORQUE_DRIVEN, Hardware
from sot.hardware.readings import Readings
from sot.hardware.servo import JointTargets
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing

MAX_PHYSICS_TIMESTEP = 0.001


class World:
    """A robot on a plane at z = 0 under gravity, driven by joint torques.

    What the sensors say (`foot_wrenches`, `contact_points`, `zmp`, `touching`, `self_distance`) belongs to the physics
    step just made: the forces that acted in it and where the bodies were at its start.

    Args:
        robot: the robot, of whose tree both MuJoCo's and Pinocchio's model are made.
        timestep: time that one `step` advances, the control period [s]. It is cut into equal physics steps of at
            most `MAX_PHYSICS_TIMESTEP`, the torque held.
        mismatch: how the real robot and floor differ from the model that the controller has.
        pushes: forces on the robot's bodies over time.
        scene: what else is in the world: a function that adds to MuJoCo's specification (`mujoco.MjSpec`), or a whole
            MJCF document as text, whose names get the prefix "scene/". What may collide at all may collide with the
            robot.
        things: what the robot may handle, stand on and lean on; those with joints are part of the state.
        loads: masses that are fixed to the robot, whether its controller knows of them or not.
        hardware: servos, compliant feet and sensors of the robot; ideal torque motors and rigid soles unless given.

    Attributes:
        robot, mismatch, pushes, things, hardware: as given.
        system: the robot and the things.
        model, data: MuJoCo's, open for forces of one's own (`data.xfrc_applied`) and rendering.

    Raises:
        InputError: MuJoCo cannot compile the robot or the scene, or the robot has no body that a push names.
    """

    def __init__(
        self,
        robot: Robot,
        timestep: float = 0.001,
        mismatch: Mismatch = NO_MISMATCH,
        pushes: Sequence[Push] = (),
        scene: Scene | None = None,
        things: Sequence[Thing] = (),
        loads: Sequence[Carried] = (),
        hardware: Hardware = TORQUE_DRIVEN,
    ):
        self.robot, self.things = robot, tuple(things)
        self.system = System(robot, self.things)
        self.timestep = timestep
        self.mismatch = mismatch
        self.pushes, self.hardware = tuple(pushes), hardware
        self._substeps = max(1, ceil(timestep / MAX_PHYSICS_TIMESTEP - 1e-9))
        self.model = build_model(
            robot, timestep / self._substeps, self.mismatch.friction, scene, self.things, loads, hardware
        )
        self.mismatch.apply(self.model, robot)
        self.data = mujoco.MjData(self.model)
        self._state = RobotState(robot, self.model, self.data)
        self._thing_states = [ThingState(thing, self.model, self.data) for thing in self.system.moving_things]
        self._motors = self.data.ctrl[: self.system.na]  # the live view; what a scene drives comes after
        self._apply_pushes = Pusher(self.model, self.data, robot, self.pushes)
        self._delay_steps = round(self.mismatch.delay * self._substeps / timestep)
        self._servos = ServoDrive(hardware.servo, self.model.opt.timestep) if hardware.servo is not None else None
        self._sensors = (
            SensorSuite(self.model, self.data, robot, hardware.sensors) if hardware.sensors is not None else None
        )
        self._soles = Soles(self.model, self.data, robot)
        self.reset(self.system.rest)
        self._floor = FloorSensors(
            self.model, self.data, robot.feet, [robot.joints[joint] for joint in robot.groups["arms"]]
        )
        self._touch = TouchSensors(self.model, self.data, robot, self.things)
        self._self_distance = SelfDistance(self.model, self.data)

    def reset(self, q: np.ndarray, v: np.ndarray | None = None) -> None:
        """Start over at a Pinocchio configuration (nq,) and velocity (nv,), at rest unless given, and time 0.

        Both are the system's, or the robot's alone: then things are in their places, at rest.
        """
        mujoco.mj_resetData(self.model, self.data)
        system, nq, nv = self.system, self.robot.nq, self.robot.nv
        self._state.write(q[:nq], None if v is None else v[:nv])
        q = q if len(q) == system.nq else system.rest
        v = v if v is not None and len(v) == system.nv else np.zeros(system.nv)
        for thing, state in zip(system.moving_things, self._thing_states, strict=True):
            state.write(q[system.coordinates[thing.name]], v[system.velocities[thing.name]])
        self._random = np.random.default_rng(self.mismatch.seed)
        self._delayed: deque[np.ndarray | JointTargets] = deque()
        if self._servos is not None:
            self._servos.reset()
            self._motors[:] = self._servos.holding(*(values[-self.robot.na :] for values in self._state.read()))
        mujoco.mj_forward(self.model, self.data)
        if self._sensors is not None:
            self._sensors.reset()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.data.time

    def state(self) -> tuple[np.ndarray, np.ndarray]:
        """Configuration (nq,) and velocity (nv,) of the system in Pinocchio's conventions, the robot's first.

        Not numbers once the physics diverged.
        """
        if not self._thing_states:
            return self._state.read()
        states = [self._state.read(), *(state.read() for state in self._thing_states)]
        return np.concatenate([q for q, _ in states]), np.concatenate([v for _, v in states])

    def measured(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A state as the controller is told: with the mismatch's noise on angular velocities."""
        if self.mismatch.noise:
            v = v.copy()
            v[3 : self.robot.nv] += self.mismatch.noise * self._random.standard_normal(self.robot.nv - 3)
        return q, v

    def step(self, command: np.ndarray | JointTargets) -> None:
        """Advance one control period under the motors' torques (na,) [N m], or under what their servos are to reach.

        Motors clip torques to the effort limits. With a delay, what was commanded first acts from the start, as if it
        had been commanded before.

        Raises:
            TypeError: torques for a robot with servos, or targets for one without.
        """
        if isinstance(command, JointTargets) != (self._servos is not None):
            raise TypeError("a robot with servos takes JointTargets, and no other does")
        for _ in range(self._substeps):
            self._delayed.append(command if isinstance(command, JointTargets) else np.array(command))
            acting = self._delayed.popleft() if len(self._delayed) > self._delay_steps else self._delayed[0]
            self._motors[:] = self._servos(acting) if isinstance(acting, JointTargets) and self._servos else acting
            self._apply_pushes()
            if self._sensors is not None:
                self._sensors.step_begins()
            mujoco.mj_step(self.model, self.data)

    def applied_torque(self) -> np.ndarray:
        """Torque of each motor in the last physics step (na,) [N m]."""
        return self.data.actuator_force[: self.system.na].copy()

    def readings(self) -> Readings:
        """The robot's sensors at the start of the last physics step, with their errors.

        Raises:
            TypeError: the robot has no sensors.
        """
        if self._sensors is None:
            raise TypeError("the robot of this world has no sensors")
        return self._sensors.readings()

    def sole_deflections(self) -> np.ndarray:
        """How far each foot's bush gives way (feet, 3): roll, pitch [rad] and height [m] of the sole; 0 if rigid."""
        return self._soles.deflections()

    def foot_wrenches(self) -> dict[str, np.ndarray]:
        """Force [N] and moment about the foot frame's origin [N m] of the floor on each foot (6,), world axes."""
        return self._floor.wrenches()

    def contact_points(self) -> np.ndarray:
        """Position [m] and force of the floor on the robot [N] of each of their contacts (n, 6), world frame."""
        return self._floor.contact_points()

    def zmp(self) -> np.ndarray:
        """Measured zero-moment point (2,) on z = 0 [m], not a number where nothing is carried."""
        return self._floor.zmp()

    def touches(self) -> dict[tuple[str, str], Touch]:
        """Touch of each pair of parts of robot, things and world that do; for the parts' names see `TouchSensors`."""
        return self._touch.touches()

    def contact_touches(self, contacts: Iterable[Contact]) -> dict[str, Touch]:
        """Touch of each contact's two parts, made or not yet, by its name; those that do not touch are left out."""
        touches, out = self._touch.touches(), {}
        for contact in contacts:
            pair = self._touch.part_of(contact.surface), self._touch.part_of(contact.on)
            if pair in touches:
                out[contact.name] = touches[pair]
            elif pair[::-1] in touches:
                found = touches[pair[::-1]]
                out[contact.name] = found._replace(force=-found.force)
        return out

    def loads(self, contacts: Iterable[Contact]) -> dict[str, float]:
        """Measured normal force of each contact, made or not yet, by its name [N]; 0 where nothing touches."""
        contacts = list(contacts)
        touches = self.contact_touches(contacts)
        return {c.name: touches[c.name].normal if c.name in touches else 0.0 for c in contacts}

    def touching(self, allowed: Collection[str] = ()) -> tuple[str, ...]:
        """Sorted names of the bodies that touch the floor or what is fixed to it and should not.

        The feet may, arms may touch what is not the floor, and the bodies of the operational points that are `allowed`.
        """
        return self._floor.bodies_touching(allowed)

    def self_distance(self) -> float:
        """Least distance [m] between two parts of the robot that may collide, negative in collision; for low rates."""
        return self._self_distance()
