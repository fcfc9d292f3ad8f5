"""A robot's sensors in MuJoCo: encoders, an inertial unit, and the forces between feet and soles."""

import mujoco
import numpy as np
import pinocchio as pin

from sim.hardware.sensor_errors import ErrorModel
from sim.hardware.soles import sole_body
from sot.hardware.readings import Readings
from sot.hardware.sensors import Sensors
from sot.robots.robot import Robot
from sot.rotation import cross

Array = np.ndarray

_IMU = {
    "imu_orientation": mujoco.mjtSensor.mjSENS_FRAMEQUAT,
    "imu_angular_velocity": mujoco.mjtSensor.mjSENS_GYRO,
    "imu_specific_force": mujoco.mjtSensor.mjSENS_ACCELEROMETER,
}
_ENCODERS = {"position": mujoco.mjtSensor.mjSENS_JOINTPOS, "velocity": mujoco.mjtSensor.mjSENS_JOINTVEL}
_FORCES = {"force": mujoco.mjtSensor.mjSENS_FORCE, "moment": mujoco.mjtSensor.mjSENS_TORQUE}


def add_sensors(spec: mujoco.MjSpec, robot: Robot, sensors: Sensors) -> None:
    """Declare the sensors of a robot with sole bodies (`sim.hardware.soles`).

    Raises:
        InputError: the robot has no point that the inertial unit is said to be at.
    """
    robot.point(sensors.imu_point)
    joint, site = mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_SITE
    for quantity, kind in _ENCODERS.items():
        for name in robot.joints:
            spec.add_sensor(name=f"{name}_{quantity}", type=kind, objtype=joint, objname=name)
    for quantity, kind in _IMU.items():
        spec.add_sensor(name=quantity, type=kind, objtype=site, objname=sensors.imu_point)
    for foot in robot.feet:
        sole = sole_body(foot)
        spec.body(sole).add_site(name=sole, group=4)
        for quantity, kind in _FORCES.items():
            spec.add_sensor(name=f"{foot}_{quantity}", type=kind, objtype=site, objname=sole)


class SensorSuite:
    """Reads the sensors of a robot, with their errors.

    Args:
        model, data: MuJoCo's, the model with what `add_sensors` declares.
        robot: whose sensors.
        sensors: their errors.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, robot: Robot, sensors: Sensors) -> None:
        self._data, self._robot, self._sensors = data, robot, sensors
        self._timestep = model.opt.timestep

        def view(first: str, last: str) -> Array:
            """The live values of sensors that were declared one after the other."""
            start, end = model.sensor(first), model.sensor(last)
            return data.sensordata[int(start.adr[0]) : int(end.adr[0] + end.dim[0])]

        self._encoders = {key: view(f"{robot.joints[0]}_{key}", f"{robot.joints[-1]}_{key}") for key in _ENCODERS}
        self._imu = [view(name, name) for name in _IMU]
        self._forces = {foot: [view(f"{foot}_{key}", f"{foot}_{key}") for key in _FORCES] for foot in robot.feet}
        self._sites = {name: model.site(name).id for foot in robot.feet for name in (foot, sole_body(foot))}
        self._imu_site = model.site(sensors.imu_point).id
        self._model, self._qvel_before = model, np.zeros(model.nv)
        self._jacobian = np.zeros((3, model.nv))
        self.reset()

    def reset(self) -> None:
        """Start over: the same noise again, filters at rest."""
        sensors, random = self._sensors, np.random.default_rng(self._sensors.seed)
        counts = {"joint_position": self._robot.na, "joint_velocity": self._robot.na}
        channels = ("joint_position", "joint_velocity", "orientation", "angular_velocity", "specific_force")
        self._errors = {name: ErrorModel(getattr(sensors, name), counts.get(name, 3), random) for name in channels}
        self._force_errors = {
            foot: [ErrorModel(channel, 3, random) for channel in (sensors.force, sensors.moment)]
            for foot in self._robot.feet
        }
        self._readings: Readings | None = None

    def readings(self) -> Readings:
        """The readings at the start of the last physics step, the same ones until the next.

        Before the first step no forces are known: the feet feel nothing, and the inertial unit feels gravity alone.
        """
        begun = self._data.time > 0.0
        time = self._data.time - self._timestep if begun else 0.0
        last = self._readings
        if last is not None and last.time == time:
            return last
        passed = 0.0 if last is None else time - last.time
        orientation, angular_velocity, specific_force = self._imu
        felt = specific_force + self._acceleration_of_dampers() if begun else self._felt_at_rest()
        errors = self._errors
        self._readings = Readings(
            time,
            errors["joint_position"](self._encoders["position"], passed),
            errors["joint_velocity"](self._encoders["velocity"], passed),
            self._attitude(orientation, passed),
            errors["angular_velocity"](angular_velocity, passed),
            errors["specific_force"](felt, passed),
            {foot: self._foot_wrench(foot, passed, begun) for foot in self._robot.feet},
        )
        return self._readings

    def step_begins(self) -> None:
        """Note what the next physics step starts from."""
        self._qvel_before[:] = self._data.qvel

    def _acceleration_of_dampers(self) -> Array:
        """What the integrator, which takes dampers implicitly, adds to the acceleration that MuJoCo's sensor has (3,).

        With stiff servos the sensor's is off by several per cent.
        """
        data = self._data
        missing = (data.qvel - self._qvel_before) / self._timestep - data.qacc
        mujoco.mj_jacSite(self._model, data, self._jacobian, None, self._imu_site)
        return (self._jacobian @ missing) @ data.site_xmat[self._imu_site].reshape(3, 3)

    def _felt_at_rest(self) -> Array:
        return -self._model.opt.gravity @ self._data.site_xmat[self._imu_site].reshape(3, 3)

    def _attitude(self, wxyz: Array, passed: float) -> Array:
        """Quaternion xyzw, turned by the errors, which are a rotation vector in the unit's frame."""
        w, x, y, z = wxyz.tolist()
        turn = self._errors["orientation"](np.zeros(3), passed)
        if not turn.any():
            return np.array((x, y, z, w))
        turned = pin.Quaternion(w, x, y, z) * pin.Quaternion(pin.exp3(turn))
        return turned.coeffs().copy()

    def _foot_wrench(self, foot: str, passed: float, begun: bool) -> Array:
        """What the sole does to the foot (6,), in the foot frame and about its origin."""
        data, wrench = self._data, np.zeros(6)
        if begun:
            at, sole = self._sites[foot], self._sites[sole_body(foot)]
            axes = data.site_xmat[at].reshape(3, 3).T
            turn = axes @ data.site_xmat[sole].reshape(3, 3)
            force, moment = (-turn @ values for values in self._forces[foot])
            wrench[:3] = force
            wrench[3:] = moment + cross(axes @ (data.site_xpos[sole] - data.site_xpos[at]), force)
        force_errors, moment_errors = self._force_errors[foot]
        return np.concatenate([force_errors(wrench[:3], passed), moment_errors(wrench[3:], passed)])
