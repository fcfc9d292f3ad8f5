"""The demonstration of a box from a stand for the HRP-2-like robot, for tests."""

from functools import lru_cache
from importlib.resources import files
from pathlib import Path

from sot.motion import read, recognise
from sot.motion.feet.stance import Build
from sot.motion.objects import event_file
from sot.motion.objects.demonstration import read_objects
from sot.motion.objects.retarget import RobotDemonstration, Scale, retarget_objects
from sot.motion.plan import imitation
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.robots.things.thing import Thing

DATA = Path(str(files("scenarios.inputs"))) / "data"


@lru_cache
def box_demonstration() -> RobotDemonstration:
    """With a box of 3 kg, at 100 Hz."""
    robot = Robot.load("hrp2")
    handled = read_objects(DATA / "box_stand.objects.toml")
    human = recognise(read(DATA / "box_stand.bvh")).resampled(handled.rate)
    scale, path = Scale.of(human, Build.of(robot)), handled.objects["box"]
    things = []
    for name, level in handled.surfaces.items():
        (x, y, z), (along, across) = scale(level.centre), scale.factor * level.size
        things.append(Thing.load("stand", name, (x, y, 0.0), size=(along, across, z)))
    size = scale.factor * path.size
    stand = next(thing for thing in things if thing.name == "stand").surfaces["top"].placement.translation[2]
    place = (*scale(path.position[0])[:2], stand + 0.5 * size[2])
    system = System(robot, [*things, Thing.load("box", placement=place, size=size.tolist(), mass=3.0)])
    contacts = event_file.read(DATA / "box_stand.events.toml")
    palms = {f"{side}_hand": f"{side}_palm" for side in ("left", "right")}
    return retarget_objects(human, handled, contacts, imitation(human, robot, 100.0), system, palms)
