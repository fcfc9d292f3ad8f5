"""The scene of a demonstration in the robot's size, and what it is loaded with for the controller and for physics."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from sot.motion.objects.demonstration import HandledObjects, ObjectPath
from sot.motion.objects.retarget import Scale
from sot.robots.things.thing import Thing

Array = NDArray[np.float64]

DOOR_WIDTH_M = 0.9
"""Width of the robot's door [m]: doors do not go with the robot's size."""
DOOR_MASS_KG = 15.0
"""Mass of its leaf [kg]."""


@dataclass(frozen=True)
class ObjectOptions:
    """What the things are like; what is None stays as their models have it.

    Attributes:
        mass: Of a free thing [kg].
        friction: Of things and surfaces against each other.
        stiffness, damping: Of a hinge [N m/rad, N m s/rad].
    """

    mass: float = 3.0
    friction: float | None = None
    stiffness: float | None = None
    damping: float | None = None

    def told(self, study: str) -> list[tuple[float, str]]:
        """What tells one run of a study from another: values with their units."""
        return [(self.mass, "kg")] if study == "box" else [(self.stiffness or 0.0, "N m/rad")]


def scene_things(
    handled: HandledObjects,
    scale: Scale,
    options: ObjectOptions,
    offsets: dict[str, pin.SE3] | None = None,
    share: float = 1.0,
) -> list[Thing]:
    """The surfaces and the objects of a demonstration as things in the robot's size.

    Args:
        handled: The human's objects.
        scale: From the human's world to the robot's.
        options: What the objects are like.
        offsets: By how much free objects are off their places, in their own axes: placement noise.
        share: Of the objects' mass that they have.
    """
    things: list[Thing] = []
    for name, level in handled.surfaces.items():
        centre, (along, across) = scale(level.centre), scale.factor * level.size
        things.append(
            Thing.load(
                "stand", name, (centre[0], centre[1], 0.0), size=(along, across, centre[2]), friction=options.friction
            )
        )
    for name, path in handled.objects.items():
        if path.hinged:
            things.append(
                Thing.load(
                    "door",
                    name,
                    _hinge(path, scale),
                    mass=None if share == 1.0 else share * DOOR_MASS_KG,
                    stiffness=options.stiffness,
                    damping=options.damping,
                    friction=options.friction,
                )
            )
        else:
            size = scale.factor * path.size
            place = pin.SE3(path.rotation[0], _resting_centre(path, scale, size))
            if offsets and name in offsets:
                place = place * offsets[name]
            things.append(
                Thing.load("box", name, place, mass=share * options.mass, size=size.tolist(), friction=options.friction)
            )
    return things


def placement_noise(handled: HandledObjects, seed: int, distance: float, angle: float) -> dict[str, pin.SE3]:
    """Offsets of the free objects: of normal distribution in two places [m] and in their heading [rad]."""
    random = np.random.default_rng(seed)
    return {name: random_offset(random, distance, angle) for name, path in handled.objects.items() if not path.hinged}


def random_offset(random: np.random.Generator, distance: float, angle: float) -> pin.SE3:
    """An offset of a level thing: of normal distribution in its heading [rad], and in two places [m]."""
    turn = pin.exp3(np.array([0.0, 0.0, angle * random.standard_normal()]))
    return pin.SE3(turn, np.array([*(distance * random.standard_normal(2)), 0.0]))


def _resting_centre(path: ObjectPath, scale: Scale, size: Array) -> Array:
    centre = scale(path.position[0])
    bottom = scale(path.position[0] - [0.0, 0.0, 0.5 * path.size[2]])[2]
    return np.array([centre[0], centre[1], bottom + 0.5 * size[2]])


def _hinge(path: ObjectPath, scale: Scale) -> Array:
    """Where the hinge of the robot's door stands: its leaf's middle is as far to the side as the human's, in size."""
    centre = scale(path.position[0])
    return np.array([centre[0], centre[1] + 0.5 * DOOR_WIDTH_M, 0.0])
