"""A guess as the text of a robot file."""

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from sot.robots.guess.guess import Guess
from sot.robots.guess.limits import ACCELERATION_HARD
from sot.robots.guess.points import Array, Point
from sot.robots.guess.rest import angles_by_name
from sot.robots.robot import POINTS

TOES = ("left_toe", "right_toe")
DIGITS = 5  # of lengths [m]


def robot_file(found: Guess, folder: Path) -> str:
    """The text (TOML) of a guess, for a file in a folder."""
    posed, body = found.posed, found.body
    model = Path(os.path.relpath(found.path.resolve(), folder.resolve())).as_posix()
    label = str(posed.model.names[: posed.model.names.index(b"\0")].decode()) or found.path.stem
    lines = [
        "# Guessed by `sot robot new`: look at the picture beside it, and at what it was not sure of.",
        f"label = {_string(label)}",
        f"model = {_string(model)}",
    ]
    moving = [j for group in body.groups.values() for j in group]
    if found.rest.key and not body.locked:
        lines.append(f"rest = {_string(found.rest.key)} # a key frame of the model")
    else:
        lines += ["", "[rest] # rad; the others are zero", *_numbers(angles_by_name(posed, found.rest, moving))]
    if body.locked:
        angles = {posed.joint_name(j): float(found.rest.qpos[posed.model.jnt_qposadr[j]]) for j in body.locked}
        lines += ["", "[locked] # rad or m: no joints of the robot", *_numbers(angles)]
    posed.place(found.start)
    lines += ["", "[points] # name = a place in a frame of the model [m]"]
    lines += [f"{name} = {_point(found, found.points.places[name])}" for name in (*POINTS, *TOES)]
    lines += ["", "[soles] # corners in the foot's frame [m]"]
    for side, corners in found.soles.items():
        foot = found.points.places[f"{side}_foot"]
        lines.append(f"{side}_foot = [{', '.join(_vector(corner - foot.at) for corner in corners)}]")
    lines += ["", "[groups]"]
    for group, joints in body.groups.items():
        lines.append(f"{group} = [{', '.join(_string(posed.joint_name(j)) for j in joints)}]")
    units = {"velocity": "rad/s", "effort": "N m", "acceleration": "rad/s², for references and braking"}
    tables = {name: getattr(found.limits, name) for name in units}
    alike = {n: v for n, v in tables.items() if len(v) == len(moving) and len(set(v.values())) == 1}
    lines += ["", "[limits]"]
    lines += [f"{name} = {next(iter(values.values()))} # {units[name]}" for name, values in alike.items()]
    lines.append(f"acceleration_hard = {ACCELERATION_HARD} # rad/s², bound of a tick")
    for name, values in tables.items():
        if values and name not in alike:
            lines += ["", f"[limits.{name}] # {units[name]}", *_numbers(values)]
    posed.place(found.rest.qpos)
    return "\n".join(lines) + "\n"


def _point(found: Guess, point: Point) -> str:
    data = found.posed.data
    offset = data.xmat[point.link].reshape(3, 3).T @ (point.at - data.xpos[point.link])
    name = _string(found.posed.name(point.link))
    if np.abs(offset).max() < 0.5 * 10.0**-DIGITS:
        return name
    return f"{{ frame = {name}, position = {_vector(offset)} }}"


def _vector(values: Array) -> str:
    return f"[{', '.join(str(round(float(value), DIGITS) + 0.0) for value in values)}]"


def _numbers(values: Mapping[str, float]) -> Iterable[str]:
    return (f"{_key(name)} = {round(value, 4) + 0.0}" for name, value in values.items())


def _key(name: str) -> str:
    plain = name.isascii() and name.replace("_", "").replace("-", "").isalnum()
    return name if plain else _string(name)


def _string(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
