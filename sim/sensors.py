"""Sensors of a world: forces between floor and robot, and least distances between the robot's parts."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from math import nan

import mujoco
import numpy as np

from sim.hardware.soles import sole_bodies

ROBOT_BODY = 1  # the body at the root of the robot: the first of the world
DISTANCE_LIMIT_M = 10.0  # MuJoCo may stop measuring a distance here
WHOLE_ROBOT = "robot"  # the sensor of the whole robot, beside one a foot
_SENSOR_FIELDS = ("FOUND", "FORCE", "TORQUE", "POS")
_SENSOR_WIDTH = 10  # numbers of these fields: 1 + 3 + 3 + 3
ON = " on "  # between the part and what it touches in a sensor's name
_HIDDEN_GROUP = 5  # a group that viewers do not show
_NET_WRENCH_REDUCTION = 3  # MuJoCo's code for contacts reduced to one wrench


class FloorSensors:
    """Net wrenches of the floor (every static geom) on each foot and on the whole robot, by MuJoCo's contact sensors.

    Args:
        model, data: MuJoCo's, the model with what `add_to` declares.
        feet: names of the feet.
        arms: joints of the arms.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, feet: Sequence[str], arms: Sequence[str] = ()):
        self._model, self._data = model, data
        # Live views: to ask MuJoCo for its arrays anew takes longer than to read them.
        names = [model.sensor(k).name for k in range(model.nsensor)]
        self._sensed = {
            part: [data.sensordata[_sensor_slice(model, name)] for name in names if name.split(ON)[0] == part]
            for part in (WHOLE_ROBOT, *feet)
        }
        sites = {foot: model.site(_site_name(foot)).id for foot in feet}
        self._origins = {foot: data.site_xpos[site] for foot, site in sites.items()}
        self._floor = int(model.geom("floor").id)
        self._arm_bodies = {int(model.joint(arm).bodyid[0]) for arm in arms}
        self._foot_bodies = {int(model.body_weldid[body]) for body in sole_bodies(model, feet).values()}

    @staticmethod
    def add_to(spec: mujoco.MjSpec, feet: Mapping[str, tuple[mujoco.MjsBody, np.ndarray]]) -> None:
        """Declare the sensors: of the first body of the world, the robot's base with all it carries, and of each foot.

        Args:
            spec: of the scene, with all fixed bodies that feet may stand on.
            feet: name of a foot -> its body and the origin of the foot frame in it [m].
        """
        grounds = ["world", *_fixed_bodies(spec.worldbody)]
        _add_contact_sensors(spec, WHOLE_ROBOT, spec.worldbody.first_body(), grounds)
        for foot, (body, origin) in feet.items():
            _add_contact_sensors(spec, foot, body, grounds)
            body.add_site(name=_site_name(foot), pos=origin, group=_HIDDEN_GROUP)

    def wrenches(self) -> dict[str, np.ndarray]:
        """Force and moment about the foot frame's origin, by foot (6,), world axes [N, N m]."""
        out = {}
        for foot, origin in self._origins.items():
            fx, fy, fz, mx, my, mz = self._wrench(foot, *origin.tolist())
            out[foot] = np.array((fx, fy, fz, mx, my, mz))
        return out

    def zmp(self) -> np.ndarray:
        """Centres of pressure of the feet, each at the height of its sole, in their mean by load (2,) [m]; nan without.

        With all soles on one level it is the point about which the floor's forces have no horizontal moment.
        """
        load = x_moment = y_moment = 0.0
        for foot, origin in self._origins.items():
            _, _, fz, mx, my, _ = self._wrench(foot, 0.0, 0.0, float(origin[2]))
            load, x_moment, y_moment = load + fz, x_moment + mx, y_moment + my
        if not load > 0.0:
            return np.array((nan, nan))
        return np.array((-y_moment / load, x_moment / load))

    def _wrench(self, part: str, ox: float, oy: float, oz: float) -> tuple[float, float, float, float, float, float]:
        """Force on a part, and its moment about a point of the world."""
        out = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for sensed in self._sensed[part]:
            _, fx, fy, fz, mx, my, mz, x, y, z = sensed.tolist()
            x, y, z = x - ox, y - oy, z - oz
            a, b, c, d, e, f = out
            out = a + fx, b + fy, c + fz, d + mx + y * fz - z * fy, e + my + z * fx - x * fz, f + mz + x * fy - y * fx
        return out

    def bodies_touching(self, allowed: Collection[str] = ()) -> tuple[str, ...]:
        """Sorted names of the robot's bodies that touch the floor or what is fixed to it and should not.

        That is all but the feet, arms on what is not the floor, and the bodies of the sites that are allowed to.
        """
        found = {part: sum(float(sensed[0]) for sensed in sensors) for part, sensors in self._sensed.items()}
        if found.pop(WHOLE_ROBOT) == sum(found.values()):
            return ()
        model, bodies = self._model, set()
        free = self._foot_bodies | {int(model.body_weldid[model.site(site).bodyid[0]]) for site in allowed}
        for k, body, _ in self._contacts():
            own = int(model.body_weldid[body])
            if own not in free and (own not in self._arm_bodies or self._floor in self._data.contact.geom[k]):
                bodies.add(body)
        return tuple(sorted(model.body(body).name for body in bodies))

    def contact_points(self) -> np.ndarray:
        """Position and force on the robot of each contact with the floor (n, 6), world frame [m, N]."""
        contacts = list(self._contacts())
        position, frame = self._data.contact.pos, self._data.contact.frame.reshape(-1, 3, 3)
        out = np.empty((len(contacts), 6))
        wrench = np.empty(6)
        for row, (k, _, sign) in zip(out, contacts, strict=True):
            mujoco.mj_contactForce(self._model, self._data, k, wrench)
            row[:3] = position[k]
            row[3:] = sign * wrench[:3] @ frame[k]
        return out

    def _contacts(self) -> Iterator[tuple[int, int, float]]:
        """Index, body of the robot, and the sign that turns MuJoCo's force, on the second geom, into the robot's."""
        bodies = self._model.geom_bodyid[self._data.contact.geom]
        static = (self._model.body_weldid[bodies] == 0).tolist()
        own = (self._model.body_rootid[bodies] == ROBOT_BODY).tolist()
        for k, (first, second) in enumerate(bodies.tolist()):
            if static[k][0] and own[k][1]:
                yield k, second, 1.0
            elif static[k][1] and own[k][0]:
                yield k, first, -1.0


def _site_name(foot: str) -> str:
    return f"{foot}_sensor"


def _sensor_slice(model: mujoco.MjModel, sensor: str) -> slice:
    start = int(model.sensor(sensor).adr[0])
    return slice(start, start + _SENSOR_WIDTH)


def _fixed_bodies(body: mujoco.MjsBody) -> Iterator[str]:
    """Names of the bodies with shapes that are fixed to one, and to those."""
    for child in body.bodies:
        if not child.joints:
            if child.geoms:
                yield child.name
            yield from _fixed_bodies(child)


def _add_contact_sensors(spec: mujoco.MjSpec, part: str, body: mujoco.MjsBody, grounds: Sequence[str]) -> None:
    """Sensors of the net wrench that each fixed body puts on a body and all that it carries."""
    fields = sum(1 << int(getattr(mujoco.mjtConDataField, f"mjCONDATA_{field}")) for field in _SENSOR_FIELDS)
    for ground in grounds:
        spec.add_sensor(
            name=part if ground == "world" else f"{part}{ON}{ground}",
            type=mujoco.mjtSensor.mjSENS_CONTACT,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            objname=ground,
            reftype=mujoco.mjtObj.mjOBJ_XBODY,
            refname=body.name,
            intprm=[fields, _NET_WRENCH_REDUCTION, 1],
        )


class SelfDistance:
    """Least distance between parts of the robot that may collide: the model's pairs of geoms.

    Bounding spheres order the pairs of geoms, so that few need their exact distance.

    Args:
        model, data: MuJoCo's.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData):
        self._model, self._data = model, data
        self._first, self._second = model.pair_geom1.copy(), model.pair_geom2.copy()
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
            least = min(least, mujoco.mj_geomDistance(self._model, self._data, *pair, DISTANCE_LIMIT_M, None))
        return least
