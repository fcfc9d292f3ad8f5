"""`sot run humanoidbench package`: a tall light box on the floor is brought to another place."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from scenarios.humanoidbench.size import scene_scale
from scenarios.otani2017.carrying.carry import Carried, carry_figures, carry_out
from scenarios.otani2017.carrying.scene import BOX
from scenarios.replay import Dance, ProgressCallback, Replay
from sot.errors import InputError
from sot.motion.carrying.fetch import box_ahead, fetch
from sot.motion.feet.footwork import Foothold
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing

Array = np.ndarray

SIZE_M = (0.4, 0.2, 0.7)
"""Size of the benchmark's package along x, y and z [m]."""
MASS_KG = 0.28
"""Its mass: 5 kg/m³ [kg]."""
FIELD_M = 2.0
"""Half the side of the square in which the benchmark's package and its destination lie [m]."""
REACHED_M = 0.1
"""Distance of the package's middle from its destination within which it is there [m]."""
CLEAR_M = 0.55
"""Distance that the robot's middle keeps from the package's until it stands before it, in the benchmark's size [m]."""
BEFORE_M = 0.3
"""Last way straight ahead to the package, in the benchmark's size [m]."""
MIN_TURN_RAD, MIN_WAY_M = 0.02, 0.01
"""Turn and way that are not worth a stop."""
MAX_DRAWS = 100
"""Number of places that are drawn before none is said to do."""


@dataclass(frozen=True)
class PackageScene:
    """Where the package stands and where it is to be, from the robot's place at the start (2,) [m]."""

    package: Array
    destination: Array
    scale: float

    @staticmethod
    def of(robot: Robot, seed: int) -> "PackageScene":
        """The scene of a seed: both places anywhere in the square.

        A place at which the robot could not walk up to the package is drawn again.

        Raises:
            InputError: None of many places does.
        """
        scale = scene_scale(robot)
        random = np.random.default_rng(seed)
        for _ in range(MAX_DRAWS):
            package, destination = scale * random.uniform(-FIELD_M, FIELD_M, (2, 2))
            scene = PackageScene(package, destination, scale)
            if scene._before(robot) is not None:
                return scene
        raise InputError(f"{robot.label} cannot get to any of {MAX_DRAWS} places of the package")

    def size(self) -> tuple[float, float, float]:
        """Of the package, as the robot before it sees it: ahead, to the side and up [m]."""
        across, ahead, up = (self.scale * length for length in SIZE_M)
        return ahead, across, up

    def approach(self, robot: Robot) -> list[Foothold]:
        """Stops of the body until the package is before it, a broad side between the hands.

        Raises:
            InputError: The package stands where the robot cannot get to it.
        """
        found = self._before(robot)
        if found is None:
            raise InputError(f"{robot.label} cannot get to a package so near to it")
        place, heading = found
        back = place - self.scale * BEFORE_M * _ahead(heading)
        start = Foothold(0.0, 0.0, 0.0)
        return [*_walk(start, back, heading), Foothold(float(place[0]), float(place[1]), heading)]

    def way(self, robot: Robot, start: Foothold) -> list[Foothold]:
        """Stops of the body with the package: it turns to the destination, and walks until the package is there."""
        body = np.array([start.x, start.y])
        off = self.destination - body
        heading = _nearest_turn(start.heading, float(np.arctan2(off[1], off[0])))
        end = self.destination - box_ahead(robot) * _ahead(heading)
        turned = Foothold(start.x, start.y, heading)
        moved = Foothold(float(end[0]), float(end[1]), heading)
        return [stop for stop, before in ((turned, start), (moved, turned)) if _differs(stop, before)]

    def _before(self, robot: Robot) -> tuple[Array, float] | None:
        """Where the body stands before the package, and its heading: on the side with the shorter clear way."""
        found = []
        for side in (1.0, -1.0):
            heading = side * 0.5 * np.pi
            place = self.package - box_ahead(robot) * _ahead(heading)
            back = place - self.scale * BEFORE_M * _ahead(heading)
            if _distance(self.package, back) > self.scale * CLEAR_M:
                found.append((float(np.linalg.norm(back)), place, heading))
        return min(found, key=lambda one: one[0])[1:] if found else None


def perform(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Carried, PackageScene]:
    """Plan and run; nothing is written."""
    robot = Robot.load(request.robot)
    tell("planning", None)
    scene = PackageScene.of(robot, seed)
    approach = scene.approach(robot)
    plan = fetch(robot, scene.size(), MASS_KG, approach, scene.way(robot, approach[-1]), request.rate)
    box = Thing.load("box", BOX, plan.box[0], mass=MASS_KG, size=list(plan.size))
    return carry_out(request, plan, System(robot, [box]), [box], tell), scene


def figures(done: Carried, scene: PackageScene) -> dict[str, Any]:
    """What became of the package."""
    found = carry_figures(done)
    end = np.array(found["objects"][BOX]["end_m"])
    off = float(np.linalg.norm(end - [*scene.destination, 0.5 * scene.size()[2]]))
    own = {
        "package_m": scene.package.tolist(),
        "destination_m": scene.destination.tolist(),
        "off_destination_m": off,
        "reached": off < REACHED_M and done.danced.run.fell_at_s is None,
    }
    return {**found, "humanoidbench": own}


def _walk(start: Foothold, goal: Array, heading: float) -> list[Foothold]:
    """Stops of a body that turns to a place (2,), goes there straight and turns to a heading."""
    off = goal - [start.x, start.y]
    toward = _nearest_turn(start.heading, float(np.arctan2(off[1], off[0])))
    x, y = goal.tolist()
    stops = [Foothold(start.x, start.y, toward), Foothold(x, y, toward), Foothold(x, y, _nearest_turn(toward, heading))]
    return [stop for stop, before in zip(stops, [start, *stops], strict=False) if _differs(stop, before)]


def _differs(stop: Foothold, other: Foothold) -> bool:
    way = np.hypot(stop.x - other.x, stop.y - other.y)
    return bool(way > MIN_WAY_M or abs(stop.heading - other.heading) > MIN_TURN_RAD)


def _nearest_turn(heading: float, wanted: float) -> float:
    """A wanted heading, unwrapped so that it is at most half a turn from another one [rad]."""
    return heading + float(pin.log3(pin.utils.rotate("z", wanted - heading))[2])


def _ahead(heading: float) -> Array:
    return np.array([np.cos(heading), np.sin(heading)])


def _distance(point: Array, goal: Array) -> float:
    """Distance of a point (2,) from the straight way from the origin to a goal (2,) [m]."""
    share = np.clip(point @ goal / max(goal @ goal, 1e-12), 0.0, 1.0)
    return float(np.linalg.norm(point - share * goal))


def scene_run(request: Replay, seed: int, tell: ProgressCallback) -> tuple[Dance, dict[str, Any]]:
    """Plan and run the scene of a seed: the run, and its figures."""
    done, scene = perform(request, seed, tell)
    return done.danced, figures(done, scene)


def sentence(own: dict[str, Any]) -> str:
    """What became of it, for a reader."""
    return f"the package's middle {1e3 * own['off_destination_m']:.0f} mm off its destination"
