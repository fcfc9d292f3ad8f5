"""MuJoCo with a robot on a floor: torques in, state and contact forces out. It never helps the robot."""

from collections import deque
from collections.abc import Sequence
from math import ceil

import mujoco
import numpy as np

from sim.mismatch import NO_MISMATCH, Mismatch
from sim.own_scene import Scene
from sim.push import Push, Pusher
from sim.robot_state import RobotState
from sim.scene import build_model
from sim.sensors import FloorSensors, SelfDistance
from sot.robots.robot import Robot

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
            robot. Touching what does not move counts as touching the floor.

    Attributes:
        robot, mismatch, pushes: as given.
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
    ):
        self.robot = robot
        self.timestep = timestep
        self.mismatch = mismatch
        self.pushes = tuple(pushes)
        self._substeps = max(1, ceil(timestep / MAX_PHYSICS_TIMESTEP - 1e-9))
        self.model = build_model(robot, timestep / self._substeps, self.mismatch.friction, scene)
        self.mismatch.apply(self.model)
        self.data = mujoco.MjData(self.model)
        self._state = RobotState(robot, self.model, self.data)
        self._motors = self.data.ctrl[: robot.na]  # the live view; what a scene drives comes after
        self._apply_pushes = Pusher(self.model, self.data, robot, self.pushes)
        self._delay_steps = round(self.mismatch.delay * self._substeps / timestep)
        self.reset(robot.rest)
        self._floor = FloorSensors(self.model, self.data, robot.feet)
        self._self_distance = SelfDistance(self.model, self.data)

    def reset(self, q: np.ndarray, v: np.ndarray | None = None) -> None:
        """Start over at a Pinocchio configuration (nq,) and velocity (nv,), at rest unless given, and time 0."""
        mujoco.mj_resetData(self.model, self.data)
        self._state.write(q, v)
        mujoco.mj_forward(self.model, self.data)
        self._random = np.random.default_rng(self.mismatch.seed)
        self._delayed_torques: deque[np.ndarray] = deque()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.data.time

    def state(self) -> tuple[np.ndarray, np.ndarray]:
        """Configuration (nq,) and velocity (nv,) in Pinocchio's conventions; not numbers once the physics diverged."""
        return self._state.read()

    def measured(self, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A state as the controller is told: with the mismatch's noise on angular velocities."""
        if self.mismatch.noise:
            v = v.copy()
            v[3:] += self.mismatch.noise * self._random.standard_normal(self.robot.nv - 3)
        return q, v

    def step(self, tau: np.ndarray) -> None:
        """Advance one control period under joint torques (na,) [N m]; the motors clip them to the effort limits.

        With a delay, what was commanded first acts from the start, as if it had been commanded before.
        """
        for _ in range(self._substeps):
            self._delayed_torques.append(np.array(tau))
            self._motors[:] = (
                self._delayed_torques.popleft()
                if len(self._delayed_torques) > self._delay_steps
                else self._delayed_torques[0]
            )
            self._apply_pushes()
            mujoco.mj_step(self.model, self.data)

    def foot_wrenches(self) -> dict[str, np.ndarray]:
        """Force [N] and moment about the foot frame's origin [N m] of the floor on each foot (6,), world axes."""
        return self._floor.wrenches()

    def contact_points(self) -> np.ndarray:
        """Position [m] and force of the floor on the robot [N] of each of their contacts (n, 6), world frame."""
        return self._floor.contact_points()

    def zmp(self) -> np.ndarray:
        """Measured zero-moment point (2,) on z = 0 [m], not a number where nothing is carried."""
        return self._floor.zmp()

    def touching(self) -> tuple[str, ...]:
        """Names of the bodies other than the feet that touch the floor, sorted."""
        return self._floor.bodies_touching()

    def self_distance(self) -> float:
        """Least distance [m] between two parts of the robot that may collide, negative in collision; for low rates."""
        return self._self_distance()
