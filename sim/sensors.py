"""What a world measures: forces between floor and robot, and how near the robot's parts come to one another."""

from collections.abc import Iterator, Sequence
from math import nan

import mujoco
import numpy as np

FAR = 10.0  # m, where MuJoCo may stop measuring a distance
WHOLE = "robot"  # the sensor of the whole robot, beside one a foot
_FIELDS = ("FOUND", "FORCE", "TORQUE", "POS")
_WIDTH = 10  # numbers of these fields: 1 + 3 + 3 + 3
_NET_FORCE = 3  # MuJoCo's code for contacts reduced to one wrench


class FloorSensors:
    """Net wrenches of the floor (every static geom) on each foot and on the whole robot, by MuJoCo's contact sensors.

    Args:
        model, data: MuJoCo's, the model with the sensors that `add_to` declares.
        feet: for each foot its name, its body, and the origin of the foot frame in that body [m].
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, feet: Sequence[tuple[str, int, np.ndarray]]):
        self._model, self._data = model, data
        self._feet = feet
        self._sensed = {name: _slice(model, name) for name in (WHOLE, *(foot[0] for foot in feet))}
        self._foot_bodies = {int(model.body_weldid[body]) for _, body, _ in feet}
        self._robot = int(model.body_rootid[feet[0][1]])

    @staticmethod
    def add_to(spec: mujoco.MjSpec, bodies: dict[str, str]) -> None:
        """Declare one sensor for each body, under the name given for it; it covers all that the body carries."""
        fields = sum(1 << int(getattr(mujoco.mjtConDataField, f"mjCONDATA_{name}")) for name in _FIELDS)
        for name, body in bodies.items():
            spec.add_sensor(
                name=name,
                type=mujoco.mjtSensor.mjSENS_CONTACT,
                objtype=mujoco.mjtObj.mjOBJ_BODY,
                objname="world",
                reftype=mujoco.mjtObj.mjOBJ_XBODY,
                refname=body,
                intprm=[fields, _NET_FORCE, 1],
            )

    def wrenches(self) -> dict[str, np.ndarray]:
        """Force and moment about the foot frame's origin, by foot (6,), world axes [N, N m]."""
        out = {}
        for foot, body, origin in self._feet:
            _, fx, fy, fz, mx, my, mz, *point = self._data.sensordata[self._sensed[foot]].tolist()
            sole = self._data.xpos[body] + self._data.xmat[body].reshape(3, 3) @ origin
            x, y, z = (np.array(point) - sole).tolist()
            moment = (mx + y * fz - z * fy, my + z * fx - x * fz, mz + x * fy - y * fx)
            out[foot] = np.array((fx, fy, fz, *moment))
        return out

    def zmp(self) -> np.ndarray:
        """Point (2,) of z = 0 about which the floor's forces have no horizontal moment [m]; nan where none carries."""
        _, fx, fy, fz, mx, my, _, x, y, z = self._data.sensordata[self._sensed[WHOLE]].tolist()
        if not fz > 0.0:
            return np.array((nan, nan))
        return np.array((x - (my + z * fx) / fz, y + (mx - z * fy) / fz))

    def touching(self) -> tuple[str, ...]:
        """Sorted names of the robot's bodies in contact with the floor, feet left out."""
        found = {name: self._data.sensordata[sensed.start] for name, sensed in self._sensed.items()}
        if found.pop(WHOLE) == sum(found.values()):
            return ()
        bodies = {body for _, body, _ in self._contacts() if self._model.body_weldid[body] not in self._foot_bodies}
        return tuple(sorted(self._model.body(body).name for body in bodies))

    def points(self) -> np.ndarray:
        """Position and force on the robot of each contact with the floor (n, 6), world frame [m, N]."""
        rows = []
        wrench = np.zeros(6)
        for k, _, sign in self._contacts():
            contact = self._data.contact[k]
            mujoco.mj_contactForce(self._model, self._data, k, wrench)
            rows.append((*contact.pos, *(sign * contact.frame.reshape(3, 3).T @ wrench[:3])))
        return np.array(rows).reshape(-1, 6)

    def _contacts(self) -> Iterator[tuple[int, int, float]]:
        """Index, body of the robot, and the sign that turns MuJoCo's force, on the second geom, into the robot's."""
        for k, geoms in enumerate(self._data.contact.geom):
            first, second = self._model.geom_bodyid[geoms].tolist()
            if self._model.body_weldid[first] == 0 and self._model.body_rootid[second] == self._robot:
                yield k, second, 1.0
            elif self._model.body_weldid[second] == 0 and self._model.body_rootid[first] == self._robot:
                yield k, first, -1.0


def _slice(model: mujoco.MjModel, sensor: str) -> slice:
    start = int(model.sensor(sensor).adr[0])
    return slice(start, start + _WIDTH)


class SelfDistance:
    """Least distance between parts of the robot that MuJoCo would let collide.

    Bounding spheres order the pairs of geoms, so that few need their exact distance.

    Args:
        model, data: MuJoCo's.
        robot: the body at the root of the robot.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robot: int):
        self._model, self._data = model, data
        own = np.flatnonzero(model.body_rootid[model.geom_bodyid] == robot).tolist()
        pairs = [(a, b) for a in own for b in own if a < b and _may_collide(model, a, b)]
        self._first, self._second = np.array(pairs, dtype=int).reshape(-1, 2).T
        self._radii = model.geom_rbound[self._first] + model.geom_rbound[self._second]

    def __call__(self) -> float:
        """The distance [m], negative in collision; infinite if no parts may collide."""
        centres = self._data.geom_xpos
        apart = np.linalg.norm(centres[self._first] - centres[self._second], axis=1) - self._radii
        least = np.inf
        for k in np.argsort(apart):
            if apart[k] >= least:
                break
            pair = int(self._first[k]), int(self._second[k])
            least = min(least, mujoco.mj_geomDistance(self._model, self._data, *pair, FAR, None))
        return least


def _may_collide(model: mujoco.MjModel, a: int, b: int) -> bool:
    """MuJoCo's rule: bits that meet, on two bodies that are not parent and child and not excluded."""
    bits = model.geom_contype[a] & model.geom_conaffinity[b] or model.geom_contype[b] & model.geom_conaffinity[a]
    first, second = sorted(int(model.body_weldid[model.geom_bodyid[geom]]) for geom in (a, b))
    parent = model.body_weldid[model.body_parentid[second]]
    excluded = (first << 16) + second in model.exclude_signature
    return bool(bits) and first != second and parent != first and not excluded
