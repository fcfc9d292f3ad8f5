"""The robot as it stands at rest: its base turned to look along +X, its points in the world's axes, its soles flat."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sot.robots.posture import UPRIGHT_POINTS, standing_rotation
from sot.robots.reading.tree import Tree
from sot.robots.robot_file import FEET, RobotFile
from sot.robots.soles import heights_over_shapes, refuse_uneven, with_soles
from sot.toml_file import nearest

Array = np.ndarray


class Standing(NamedTuple):
    """A robot at rest.

    Attributes:
        tree: with its points as sites and its feet as they touch the floor; at rest the base's axes are the world's.
        base: position of the base at rest (3,) [m], the lowest corner of the soles on z = 0.
        soles: foot -> corners (n, 3) in the foot's frame [m].
    """

    tree: Tree
    base: Array
    soles: Mapping[str, Array]


class _Place(NamedTuple):
    """A place in a link."""

    link: int
    placement: pin.SE3

    def __matmul__(self, places: Sequence[pin.SE3]) -> pin.SE3:
        """Where it is in the world, given the links' places."""
        return places[self.link] * self.placement


def stand(
    file: RobotFile, tree: Tree, model: pin.Model, rotation: Array, angles: Array, remarks: list[str]
) -> Standing:
    """The robot of a file as it stands at rest.

    Args:
        file: of the robot.
        tree, model: the robot as its model file has it.
        rotation: of the base at rest in that file (3, 3).
        angles: of the joints at rest (na,) [rad].
        remarks: what is turned or does not fit is added to these.

    Raises:
        InputError: a point or corner names no frame, the robot does not stand upright, or its soles are not flat.
    """
    found = {name: _find(file, f"points.{name}", tree, *value) for name, value in file.points().items()}
    before = _link_places(tree, model, angles)
    in_base = {name: (at @ before).translation for name, at in found.items()}
    turn = pin.SE3(standing_rotation(file, rotation, in_base, remarks), np.zeros(3))
    tree = tree.with_base_turned(turn.rotation)
    places = [pin.SE3.Identity(), *(turn * place for place in before[1:])]
    found = {name: _turned(at, turn) for name, at in found.items()}

    origins = {foot: (found[foot] @ places).translation for foot in FEET}
    links = {foot: tree.owners[found[foot].link] for foot in FEET}
    corners = {foot: _corners(file, foot, tree, places, turn, origins[foot], links[foot]) for foot in FEET}
    for foot, height in heights_over_shapes(tree, links, places, corners, remarks).items():
        lower = np.array([0.0, 0.0, -height])
        origins[foot], corners[foot] = origins[foot] + lower, corners[foot] + lower
        at = found[foot]
        found[foot] = at._replace(placement=at.placement * pin.SE3(np.eye(3), (at @ places).rotation.T @ lower))
    refuse_uneven(file, corners)
    soles = {foot: corners[foot] - origins[foot] for foot in FEET}
    height = min(corners[foot][:, 2].min() for foot in FEET)
    tree = with_soles(tree, links, places, corners)
    return Standing(_with_points(tree, places, found), np.array([0.0, 0.0, -height]), soles)


def _find(file: RobotFile, key: str, tree: Tree, name: str, position: Array) -> _Place:
    """A position in a frame of a name: of a joint, its link and a site of one name, the site."""
    frames: dict[str, _Place] = {}
    for k, link in enumerate(tree.links):
        frames |= {hinge.name: _Place(k, pin.SE3(np.eye(3), hinge.anchor)) for hinge in link.joints}
    frames |= {link.name: _Place(k, pin.SE3.Identity()) for k, link in enumerate(tree.links)}
    frames |= {site: _Place(k, at) for k, link in enumerate(tree.links) for site, at in link.sites}
    if name not in frames:
        raise file.error(f"'{key}' names the frame '{name}', which the model does not have{nearest(name, frames)}")
    at = frames[name]
    return _Place(at.link, at.placement * pin.SE3(np.eye(3), position))


def _link_places(tree: Tree, model: pin.Model, angles: Array) -> list[pin.SE3]:
    """The places of all links in the base."""
    data, q = model.createData(), np.concatenate([[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], angles])
    pin.framesForwardKinematics(model, data, q)
    return [data.oMf[model.getFrameId(link.name, pin.FrameType.BODY)].copy() for link in tree.links]


def _turned(at: _Place, turn: pin.SE3) -> _Place:
    """The same place when the axes of the base have been turned."""
    return _Place(0, turn * at.placement) if at.link == 0 else at


def _corners(
    file: RobotFile, foot: str, tree: Tree, places: Sequence[pin.SE3], turn: pin.SE3, origin: Array, link: int
) -> Array:
    """Corners of a sole at rest (n, 3), from frames of the foot's link or from positions in the foot's frame."""
    corners = []
    for corner in file.corners(foot):
        if isinstance(corner, str):
            at = _turned(_find(file, f"soles.{foot}", tree, corner, np.zeros(3)), turn)
            if tree.owners[at.link] != link:
                raise file.error(f"'soles.{foot}': the frame '{corner}' is on another link than the foot")
            corners.append((at @ places).translation)
        else:
            corners.append(origin + corner)
    return np.array(corners)


def _with_points(tree: Tree, places: Sequence[pin.SE3], found: Mapping[str, _Place]) -> Tree:
    """The tree with the points as sites of the links that they move with, in the place of sites of their names."""
    sites: dict[int, list[tuple[str, pin.SE3]]] = {}
    for name, at in found.items():
        owner, place = tree.owners[at.link], at @ places
        if name in UPRIGHT_POINTS:
            place = pin.SE3(np.eye(3), place.translation)
        sites.setdefault(owner, []).append((name, places[owner].actInv(place)))
    return tree.changed(
        lambda k, link: replace(link, sites=(*(site for site in link.sites if site[0] not in found), *sites.get(k, ())))
    )
