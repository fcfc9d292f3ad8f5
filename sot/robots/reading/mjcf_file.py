"""An MJCF file as MuJoCo compiles it, or why it cannot, in one line."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco

from sot.errors import InputError


def mjcf_spec(path: Path) -> mujoco.MjSpec:
    """The model as the file says, without textures and skins and what may name things of a scene.

    Raises:
        ValueError, mujoco.FatalError: MuJoCo cannot read it.
    """
    spec = mujoco.MjSpec.from_file(str(path))
    _drop_what_names_others(spec)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in list(spec.textures):
        spec.delete(texture)
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = False
    return spec


def compile_mjcf(path: Path, remarks: list[str]) -> mujoco.MjModel:
    """The model as MuJoCo reads the file, with all that is in it but textures and skins.

    Args:
        path: of the file; files that it includes and meshes are found as MuJoCo finds them.
        remarks: what had to be mended is added to these.

    Raises:
        InputError: MuJoCo cannot read it.
    """
    try:
        with _warnings_into(remarks):
            spec = mjcf_spec(path)
        try:
            return spec.compile()
        except ValueError as error:
            if "A + B >= C" not in str(error):
                raise
            link = _element(str(error))
            spec.compiler.balanceinertia = True
            compiled = spec.compile()
            remarks.append(f"inertias that no body can have (A + B < C) are mended, as of link {link}")
            return compiled
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(_complaint(path, str(error))) from None


@contextmanager
def _warnings_into(remarks: list[str]) -> Iterator[None]:
    """Collect what MuJoCo would write into a file beside the user's."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda warning: remarks.append(f"MuJoCo warns of the model: {warning}"))
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def _drop_what_names_others(spec: mujoco.MjSpec) -> None:
    """Drop skins, sensors and pairs of shapes, which may name what only a scene has; shapes of pairs collide."""
    for pair in spec.pairs:
        for geom in (spec.geom(pair.geomname1), spec.geom(pair.geomname2)):
            if geom is not None:
                geom.contype, geom.conaffinity = geom.contype | 1, geom.conaffinity | 1
    for unneeded in (*spec.skins, *spec.sensors, *spec.pairs):
        spec.delete(unneeded)


def _complaint(path: Path, error: str) -> str:
    link = _element(error)
    if "moving bodies must be larger" in error:
        return f"{path}: link '{link}' moves and has no mass or inertia: give it both, or put its joint into [locked]"
    lines = [line.strip() for line in error.splitlines() if line.strip()]
    return f"{path}: MuJoCo cannot read it: {'; '.join(lines) or 'no reason given'}"


def _element(error: str) -> str:
    found = re.search(r"Element name '([^']*)'", error)
    return found.group(1) if found else ""
