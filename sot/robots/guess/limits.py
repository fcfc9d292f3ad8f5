"""Efforts and velocities that a model leaves out, guessed from a URDF beside it or by scale."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from sot.robots.guess.evidence import Evidence, Sureness
from sot.robots.guess.groups import Body
from sot.robots.guess.points import Points
from sot.robots.guess.posed_model import PosedModel

GRAVITY = 9.81  # m/s²
NO_EFFORT, NO_VELOCITY = 1e4, 1e3  # N m and rad/s: what is no less is no limit
ACCELERATION, ACCELERATION_HARD = 60.0, 400.0  # rad/s², for references and braking, and for a tick
EFFORTS = {"hip": 0.3, "knee": 0.4, "ankle": 0.2, "chest": 0.25, "upper arm": 0.12, "forearm": 0.03, "head": 0.03}
"""Efforts of humanoids of 3 to 95 kg, as shares of weight times leg length, towards their lower end."""
VELOCITY = 2.0
"""Velocity limit by scale, in √(gravity / leg length)."""


@dataclass(frozen=True)
class Limits:
    """What the robot file has to say of limits, by joint; nothing where the model says it."""

    effort: Mapping[str, float]
    velocity: Mapping[str, float]


def find_limits(posed: PosedModel, body: Body, points: Points, path: Path) -> tuple[Limits, list[Evidence]]:
    """Limits of all joints of groups that the model does not have, or has beyond any motor's."""
    joints = [j for group in body.groups.values() for j in group]
    said = _urdf_limits(path) if path.suffix == ".urdf" else {}
    beside = {} if path.suffix == ".urdf" else _beside(path, [posed.joint_name(j) for j in joints])
    effort, velocity, evidence = dict[str, float](), dict[str, float](), list[Evidence]()
    own = model_efforts(posed)
    leg = float(np.linalg.norm(points.places["left_hip"].at - points.places["left_ankle"].at))
    scale = posed.mass(posed.base) * GRAVITY * leg
    roles = _roles(body, points)
    sources: dict[str, list[str]] = {"effort": [], "velocity": []}
    scaled: dict[str, list[str]] = {"effort": [], "velocity": []}
    for joint in joints:
        name = posed.joint_name(joint)
        other_effort, other_velocity = beside.get(name, (0.0, 0.0))
        if not 0.0 < own.get(joint, 0.0) < NO_EFFORT:
            found = 0.0 < other_effort < NO_EFFORT
            effort[name] = other_effort if found else _round(EFFORTS[roles[joint]] * scale)
            (sources if found else scaled)["effort"].append(name)
        if not 0.0 < said.get(name, (0.0, 0.0))[1] < NO_VELOCITY:
            found = 0.0 < other_velocity < NO_VELOCITY
            velocity[name] = other_velocity if found else _round(VELOCITY * float(np.sqrt(GRAVITY / leg)))
            (sources if found else scaled)["velocity"].append(name)
    for kind, unit in (("effort", "N m"), ("velocity", "rad/s")):
        values = effort if kind == "effort" else velocity
        count = len(joints) - len(values)
        if count:
            evidence.append(Evidence(f"{kind} limits", f"of {count} joints", "the model's own", Sureness.SURE))
        if sources[kind]:
            evidence.append(
                Evidence(
                    f"{kind} limits", f"of {len(sources[kind])} joints", "from a URDF beside the model", Sureness.LIKELY
                )
            )
        if scaled[kind]:
            low, high = (f(values[name] for name in scaled[kind]) for f in (min, max))
            names = "all joints" if len(scaled[kind]) == len(joints) else ", ".join(scaled[kind])
            why = "by scale: the model has none; look them up in the maker's data"
            evidence.append(Evidence(f"{kind} limits", f"{low:g} to {high:g} {unit} for {names}", why, Sureness.UNSURE))
    return Limits(effort, velocity), evidence


def model_efforts(posed: PosedModel) -> dict[int, float]:
    """Efforts that a model has by joint [N m]: of the joint, else of its actuators."""
    model, out = posed.model, dict[int, float]()
    for a in range(model.nu):
        joint = int(model.actuator_trnid[a, 0])
        if model.actuator_trntype[a] != mujoco.mjtTrn.mjTRN_JOINT:
            continue
        gear = abs(float(model.actuator_gear[a, 0]))
        if model.actuator_forcelimited[a]:
            out[joint] = gear * float(np.abs(model.actuator_forcerange[a]).max())
        elif model.actuator_ctrllimited[a] and model.actuator_biastype[a] == mujoco.mjtBias.mjBIAS_NONE:
            gain = abs(float(model.actuator_gainprm[a, 0]))
            out[joint] = gain * gear * float(np.abs(model.actuator_ctrlrange[a]).max())
    for joint in posed.joints:
        if model.jnt_actfrclimited[joint]:
            out[joint] = float(np.abs(model.jnt_actfrcrange[joint]).max())
    return out


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


def _round(value: float) -> float:
    """To two figures."""
    return float(f"{value:.2g}")
