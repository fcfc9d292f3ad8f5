"""Efforts and velocities that a model leaves out, guessed from a URDF beside it or by scale."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sot.gravity import GRAVITY
from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.groups import Body
from sot.robots.guess.points import Points
from sot.robots.guess.posed_model import PosedModel
from sot.robots.limits import EFFORT_LEVER
from sot.robots.reading.mjcf import joint_efforts

NO_VELOCITY = 1e3  # rad/s: what is no less is no limit
NEGLIGIBLE_LOSS = 1e-9  # N m s/rad and kg m², of losses that are none
ACCELERATION, ACCELERATION_HARD = 60.0, 400.0  # rad/s², for references and braking, and for a tick
SCALED_EFFORTS = {
    "hip": 0.3,
    "knee": 0.4,
    "ankle": 0.2,
    "chest": 0.25,
    "upper arm": 0.12,
    "forearm": 0.03,
    "head": 0.03,
}
"""Efforts of humanoids of 3 to 95 kg, as shares of weight times leg length, towards their lower end."""
SCALED_VELOCITY = 2.0
"""Velocity limit by scale, in √(gravity / leg length)."""
MAX_DAMPING_EFFORT_SHARE, MAX_ROTOR_EFFORT_SHARE = 0.8, 0.5
"""Shares of a motor's effort that damping may take at the velocity guessed, and the rotor's inertia in a reference."""


@dataclass(frozen=True)
class Limits:
    """What the robot file has to say of limits, by joint: efforts and velocities where the model says nothing, and the
    accelerations of references."""

    effort: Mapping[str, float]
    velocity: Mapping[str, float]
    acceleration: Mapping[str, float]


def find_limits(posed: PosedModel, body: Body, points: Points, path: Path) -> tuple[Limits, list[Evidence]]:
    """Limits of all joints of groups that the model does not have, or has beyond any motor's."""
    joints = [j for group in body.groups.values() for j in group]
    names = {j: posed.joint_name(j) for j in joints}
    weight = GRAVITY * posed.mass(posed.base)
    leg = float(np.linalg.norm(points.places["left_hip"].at - points.places["left_ankle"].at))
    is_urdf = path.suffix.lower() == ".urdf"
    own_velocity = {name: limits[1] for name, limits in (_urdf_limits(path) if is_urdf else {}).items()}
    own_effort = dict(enumerate(joint_efforts(posed.model).tolist()))
    beside = {} if is_urdf else _beside(path, list(names.values()))
    by_scale = {j: _two_figures(SCALED_EFFORTS[role] * weight * leg) for j, role in _roles(body, points).items()}
    effort, said_effort = _filled(
        "effort", "N m", names, own_effort, {n: a for n, (a, _) in beside.items()}, by_scale, EFFORT_LEVER * weight
    )
    efforts = {j: effort.get(names[j], own_effort[j]) for j in joints}
    damping, armature = ({j: _of_joint(values, posed, j) for j in joints} for values in _losses(posed))
    fastest = SCALED_VELOCITY * float(np.sqrt(GRAVITY / leg))
    # At effort over damping a motor has none left for anything else.
    by_scale = {
        j: _two_figures(min(fastest, MAX_DAMPING_EFFORT_SHARE * efforts[j] / max(damping[j], NEGLIGIBLE_LOSS)))
        for j in joints
    }
    own = {j: own_velocity.get(name, np.inf) for j, name in names.items()}
    velocity, said_velocity = _filled(
        "velocity", "rad/s", names, own, {n: v for n, (_, v) in beside.items()}, by_scale, NO_VELOCITY
    )
    acceleration = {
        names[j]: _two_figures(
            min(ACCELERATION, MAX_ROTOR_EFFORT_SHARE * efforts[j] / max(armature[j], NEGLIGIBLE_LOSS))
        )
        for j in joints
    }
    slow = [name for name, value in acceleration.items() if value < ACCELERATION]
    said = [*said_effort, *said_velocity]
    if slow:
        low, high = (f(acceleration[name] for name in slow) for f in (min, max))
        values = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        why = f"more would take over {100 * MAX_ROTOR_EFFORT_SHARE:.0f} % of the effort for the rotors' inertia"
        said.append(Evidence("acceleration", f"{values} rad/s² of {len(slow)} joints", why, Sureness.LIKELY))
    return Limits(effort, velocity, acceleration), said


def _filled(
    kind: str,
    unit: str,
    names: Mapping[int, str],
    own: Mapping[int, float],
    beside: Mapping[str, float],
    by_scale: Mapping[int, float],
    none: float,
) -> tuple[dict[str, float], list[Evidence]]:
    """Limits that the model lacks, from a URDF beside it or by scale; `none` or more is no limit."""
    lacking = {j: name for j, name in names.items() if not 0.0 < own[j] < none}
    found = {name: beside[name] for name in lacking.values() if 0.0 < beside.get(name, 0.0) < none}
    guessed = {name: by_scale[j] for j, name in lacking.items() if name not in found}
    said = []
    if len(names) > len(lacking):
        words = f"of {len(names) - len(lacking)} joints"
        said.append(Evidence(f"{kind} limits", words, "the model's own", Sureness.SURE))
    if found:
        words = f"of {len(found)} joints"
        said.append(Evidence(f"{kind} limits", words, "from a URDF beside the model", Sureness.LIKELY))
    if guessed:
        low, high = min(guessed.values()), max(guessed.values())
        which = "all joints" if len(guessed) == len(names) else ", ".join(guessed)
        values = f"{low:g} {unit}" if low == high else f"{low:g} to {high:g} {unit}"
        why = "by scale and damping, since the model has none: look them up in the maker's data"
        said.append(Evidence(f"{kind} limits", f"{values} for {which}", why, Sureness.UNSURE))
    return found | guessed, said


def _losses(posed: PosedModel) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Damping [N m s/rad] and armature [kg m²] of the model's degrees of freedom (nv,)."""
    damping = np.asarray(posed.model.dof_damping, dtype=float)
    return damping.reshape(posed.model.nv, -1)[:, 0], np.asarray(posed.model.dof_armature, dtype=float)


def _of_joint(values: NDArray[np.float64], posed: PosedModel, joint: int) -> float:
    return float(values[posed.model.jnt_dofadr[joint]])


def _beside(path: Path, joints: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Limits of the URDF near the model that has most of the joints."""
    near = [*sorted(path.parent.glob("*.urdf")), *sorted(path.parent.parent.glob("urdf/*.urdf"))]
    found = [_urdf_limits(each) for each in near]
    return max(found, key=lambda limits: len(set(limits) & set(joints)), default={})


def _urdf_limits(path: Path) -> dict[str, tuple[float, float]]:
    """Joint -> effort and velocity; nothing of a file that cannot be read."""
    try:
        root = ET.parse(path).getroot()
        limits = {str(joint.get("name")): joint.find("limit") for joint in root.findall("joint")}
        return {
            name: (float(limit.get("effort", 0.0)), float(limit.get("velocity", 0.0)))
            for name, limit in limits.items()
            if limit is not None
        }
    except (OSError, ET.ParseError, ValueError):
        return {}


def _roles(body: Body, points: Points) -> dict[int, str]:
    roles = {j: group for group in ("chest", "head") for j in body.groups[group]}
    for side in ("left", "right"):
        leg, knee = list(body.groups[f"{side}_leg"]), points.bends[f"{side}_leg"]
        at = leg.index(knee)
        roles |= {j: "hip" for j in leg[:at]} | {knee: "knee"} | {j: "ankle" for j in leg[at + 1 :]}
        arm, elbow = list(body.groups[f"{side}_arm"]), points.bends[f"{side}_arm"]
        at = arm.index(elbow)
        roles |= {j: "upper arm" for j in arm[: at + 1]} | {j: "forearm" for j in arm[at + 1 :]}
    return roles


def _two_figures(value: float) -> float:
    """To two figures."""
    return float(f"{value:.2g}")
