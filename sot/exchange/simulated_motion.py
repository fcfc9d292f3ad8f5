"""The project's own file of a run (.npz): all that the simulated robot did, tick by tick, with names and units.

docs/libraries.md lists the arrays. `sot export` reads it, and whoever trains on references with torques and forces may.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sot.array_file import read_arrays
from sot.errors import InputError
from sot.exchange.checks import checked_rate, numbers
from sot.exchange.robot_motion import RobotMotion
from sot.robots.robot import Robot
from sot.whole_file import atomic_write

Array = NDArray[np.float64]

FORMAT_VERSION = 1
FACTS_KEY = "facts"
NAMES_AND_NUMBERS = ("q", "contact", "rate", "human_rate", "joints", "feet", "human_points")


@dataclass(frozen=True, eq=False)
class SimulatedMotion:
    """What a robot did in a run. Conventions are Pinocchio's, vectors in world axes, feet left and right.

    Attributes:
        q: (T, nq) configuration: base position [m], quaternion xyzw, joints [rad].
        v: (T, nv) velocity: base in its own axes, linear and angular, then joints.
        a: (T, nv) acceleration, the change of v over a tick.
        torque: (T, na) torque commanded to the joints; of servos, of their motors [N m].
        contact: (T, 2) whether the floor carries the foot.
        wrench: (T, 2, 6) force and moment of the floor on the foot, about the foot frame's origin [N, N m].
        zmp: (T, 2) measured zero-moment point [m]; nan without load.
        zmp_margin: (T,) from the ZMP to the edge of the planned support, negative outside [m]; nan without.
        friction_margin: (T, 2) friction that is left, µ f_normal - |f_tangential| [N]; nan of a foot without load.
        reference: (T, nq) what the robot was to do.
        human: (K, P, 3) points of the human in the robot's size and place, on the reference's time line [m]; K is 0
            where there was none.
        human_rate: of these, per second [Hz].
        rate: ticks per second [Hz].
        joints, feet, human_points: names of the columns.
        facts: robot, clip, source, licence, command, revision and the like; plain text by what it tells.
    """

    q: Array
    v: Array
    a: Array
    torque: Array
    contact: NDArray[np.bool_]
    wrench: Array
    zmp: Array
    zmp_margin: Array
    friction_margin: Array
    reference: Array
    human: Array
    human_rate: float
    rate: float
    joints: tuple[str, ...]
    feet: tuple[str, ...]
    human_points: tuple[str, ...]
    facts: Mapping[str, str]

    def save(self, path: Path) -> None:
        """Write to a file (.npz), which appears under its name once it is complete: q in double, others in single
        precision."""
        single = ("v", "a", "torque", "wrench", "zmp", "zmp_margin", "friction_margin", "reference", "human")
        content: dict[str, Any] = {name: getattr(self, name).astype(np.float32) for name in single}
        content |= {name: np.array(getattr(self, name)) for name in NAMES_AND_NUMBERS}
        content[FACTS_KEY] = np.array(json.dumps({"version": FORMAT_VERSION, **self.facts}))
        with atomic_write(path) as place:
            np.savez_compressed(place, **content)

    @staticmethod
    def load(path: Path) -> "SimulatedMotion":
        """Read what `save` wrote.

        Raises:
            InputError: not such a file, damaged, or of another version.
        """
        content = read_arrays(path, "a run's motion")
        if missing := [name for name in _NEEDED if name not in content]:
            raise InputError(f"{path}: not the motion of a run, it lacks {', '.join(missing)}")
        try:
            facts = json.loads(str(content[FACTS_KEY]))
            version = facts.pop("version")
        except (ValueError, KeyError, AttributeError, TypeError):
            raise InputError(f"{path}: not the motion of a run, its facts are damaged") from None
        if version != FORMAT_VERSION:
            raise InputError(f"{path}: of another version ({version}, this one reads {FORMAT_VERSION}); run it again")
        keys = ("joints", "feet", "human_points")
        joints, feet, points = (tuple(str(name) for name in content[key].ravel()) for key in keys)
        length, joint_count = len(np.atleast_1d(content["q"])), len(joints)
        shapes = {
            "q": (7 + joint_count,),
            "v": (6 + joint_count,),
            "a": (6 + joint_count,),
            "torque": (joint_count,),
            "contact": (len(feet),),
            "wrench": (len(feet), 6),
            "zmp": (2,),
            "zmp_margin": (),
            "friction_margin": (len(feet),),
            "reference": (7 + joint_count,),
        }
        if content["human"].ndim != 3 or content["human"].shape[1:] != (len(points), 3):
            raise InputError(f"{path}: 'human' has shape {content['human'].shape}, expected (K, {len(points)}, 3)")
        for name, shape in shapes.items():
            if content[name].shape != (length, *shape):
                raise InputError(f"{path}: '{name}' has shape {content[name].shape}, expected {(length, *shape)}")
        for name in ("q", "v", "torque", "reference", "human", "human_rate"):
            numbers(path, name, content[name])
        columns: dict[str, Any] = {name: content[name].astype(float) for name in (*shapes, "human")}
        columns["contact"] = content["contact"].astype(bool)
        told = {str(key): str(value) for key, value in facts.items()}
        rate, human_rate = checked_rate(path, content["rate"]), float(content["human_rate"])
        names: dict[str, Any] = {"joints": joints, "feet": feet, "human_points": points}
        return SimulatedMotion(**columns, **names, rate=rate, human_rate=human_rate, facts=told)

    def motion(self, robot: Robot, name: str) -> RobotMotion:
        """What other formats hold of it.

        Raises:
            InputError: another robot's.
        """
        if self.joints != robot.joints:
            raise InputError(f"{name}: a run of another robot than {robot.label}: its joints are others")
        return RobotMotion(robot, name, self.rate, self.q, self.v, self.torque, self.contact, self.facts)


_NEEDED = tuple(field.name for field in fields(SimulatedMotion))
