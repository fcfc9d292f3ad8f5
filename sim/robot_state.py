"""A robot's state in a MuJoCo model, in Pinocchio's conventions."""

import mujoco
import numpy as np

from sim.convert import state_from_mujoco, state_to_mujoco
from sot.errors import InputError
from sot.robots.robot import Robot
from sot.robots.things.thing import Thing


class RobotState:
    """Reads and writes the state of a robot in MuJoCo's data, whatever else the model has in it.

    Pinocchio: quaternion xyzw, base velocity in the base frame, joints in the order of `Robot.joints`.

    Args:
        robot: The robot.
        model, data: MuJoCo's, with a free joint at the robot's base and its other joints by their names.

    Raises:
        InputError: The model has not all of the robot's joints, or no free joint at its base.
    """

    def __init__(self, robot: Robot, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        joints = {model.joint(k).name: k for k in range(model.njnt)}
        missing = [name for name in robot.joints if name not in joints]
        if missing:
            raise InputError(f"the MuJoCo model has no joint {', '.join(missing)} of {robot.label}")
        own = [joints[name] for name in robot.joints]
        base = int(model.body_jntadr[model.body_rootid[model.jnt_bodyid[own[0]]]])
        if base < 0 or model.jnt_type[base] != mujoco.mjtJoint.mjJNT_FREE:
            raise InputError(f"the MuJoCo model has no free joint at the base of {robot.label}")
        q, v = int(model.jnt_qposadr[base]), int(model.jnt_dofadr[base])
        # Passive joints of feet may stand between the robot's own.
        self._q = _as_slice([*range(q, q + 7), *model.jnt_qposadr[own].tolist()])
        self._v = _as_slice([*range(v, v + 6), *model.jnt_dofadr[own].tolist()])
        # Live views: to ask MuJoCo for its arrays anew takes longer than to read them.
        self._qpos, self._qvel = data.qpos, data.qvel

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Configuration (nq,) and velocity (nv,), new arrays; not numbers once the physics diverged."""
        return state_from_mujoco(self._qpos[self._q], self._qvel[self._v])

    def write(self, q: np.ndarray, v: np.ndarray | None = None) -> None:
        """Set a configuration (nq,) and a velocity (nv,), at rest unless given; `mujoco.mj_forward` does the rest."""
        v = np.zeros(len(q) - 1) if v is None else v
        self._qpos[self._q], self._qvel[self._v] = state_to_mujoco(q, v)


def _as_slice(places: list[int]) -> slice | np.ndarray:
    """Places in an array; as a slice, which is quicker, if they follow one another."""
    first, last = places[0], places[-1] + 1
    return slice(first, last) if places == list(range(first, last)) else np.array(places)


class ThingState:
    """Reads and writes the state of a thing in MuJoCo's data, in Pinocchio's conventions (see `RobotState`).

    Args:
        thing: A thing with joints.
        model, data: MuJoCo's, the model with the thing in it.
    """

    def __init__(self, thing: Thing, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        joint = model.joint(thing.model.names[1])
        q, v = int(joint.qposadr[0]), int(joint.dofadr[0])
        self._free = int(joint.type[0]) == mujoco.mjtJoint.mjJNT_FREE
        self._qpos, self._qvel = data.qpos[q : q + thing.nq], data.qvel[v : v + thing.nv]

    def read(self) -> tuple[np.ndarray, np.ndarray]:
        """Configuration (nq,) and velocity (nv,), new arrays."""
        return state_from_mujoco(self._qpos, self._qvel) if self._free else (self._qpos.copy(), self._qvel.copy())

    def write(self, q: np.ndarray, v: np.ndarray) -> None:
        """Set a configuration (nq,) and a velocity (nv,)."""
        self._qpos[:], self._qvel[:] = state_to_mujoco(q, v) if self._free else (q, v)
