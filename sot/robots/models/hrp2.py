"""The HRP-2-like robot as tables; `python -m sot.robots.models.hrp2` writes its model and robot files from them.

Offsets, ranges, masses, inertias and gear ratios are published figures of HRP-2 (Klampt `hrp2.rob`, stack-of-tasks
`sot-dyninv`); torque limits, losses, covers and shapes are ours. `hrp2_modified` has one roll joint more in the
chest and in the neck, as the robot of Ramos 2011.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import cos, pi, radians
from pathlib import Path

from sot.robots.models import mjcf
from sot.robots.models.hrp2_shapes import COLLISION, LOOKS, SOLE_X, SOLE_Y, SOLE_Z, VISUAL
from sot.robots.models.mjcf import Joint, Link, MassProperties, Vector

# link: (mass kg, centre of mass m, diagonal of the inertia about it kg m²), own frame, right side
MASSES: dict[str, tuple[float, Vector, Vector]] = {
    "BODY": (15.03, (-0.014, 0.0, 0.220), (0.161, 0.095, 0.192)),
    "RLEG0": (1.17, (-0.010, 0.005, 0.065), (0.0029, 0.0035, 0.0015)),
    "RLEG1": (0.81, (0.0, -0.026, -0.003), (0.0013, 0.0005, 0.0013)),
    "RLEG2": (2.08, (0.003, -0.078, -0.152), (0.0262, 0.0249, 0.0038)),
    "RLEG3": (1.75, (0.018, -0.058, -0.138), (0.0223, 0.0225, 0.0046)),
    "RLEG4": (0.65, (0.008, -0.001, -0.002), (0.0003, 0.0008, 0.0009)),
    "RLEG5": (1.64, (-0.001, -0.005, -0.065), (0.0040, 0.0069, 0.0071)),
    "CHEST0": (0.79, (-0.016, 0.005, -0.025), (0.0018, 0.0019, 0.0023)),
    "CHEST1": (11.53, (-0.029, 0.007, 0.121), (0.160, 0.137, 0.182)),
    "HEAD0": (0.38, (-0.001, 0.004, -0.008), (0.0004, 0.0002, 0.0004)),
    "HEAD1": (0.99, (0.013, 0.0, 0.079), (0.0054, 0.0046, 0.0059)),
    "RARM0": (0.81, (-0.010, 0.046, 0.0), (0.0022, 0.0018, 0.0034)),
    "RARM1": (1.03, (-0.011, -0.012, -0.009), (0.0012, 0.0017, 0.0016)),
    "RARM2": (1.60, (-0.005, -0.005, -0.167), (0.0097, 0.0097, 0.0014)),
    "RARM3": (0.78, (0.0, -0.016, -0.063), (0.0023, 0.0021, 0.0006)),
    "RARM4": (0.56, (-0.003, -0.004, 0.041), (0.0013, 0.0012, 0.0003)),
    "RARM5": (0.71, (-0.001, 0.002, -0.073), (0.0018, 0.0018, 0.0004)),
    "RARM6": (0.09, (-0.002, -0.004, -0.030), (0.0001, 0.0001, 0.00002)),
}

# The links add up to 56.08 kg of the quoted 58: shells, cabling and the back pack (ours), as bodies of the same links.
COVERS: dict[str, tuple[float, Vector, Vector]] = {
    "BODY": (1.02, (-0.040, 0.0, 0.080), (0.010, 0.008, 0.012)),
    "CHEST1": (0.9, (-0.090, 0.0, 0.100), (0.012, 0.012, 0.014)),
}

# What the roll joint's own link takes from the link it is put before; the sum stays as it was.
CUT_FOR_ROLL: dict[str, tuple[float, Vector, Vector]] = {
    "CHEST1": (0.90, (0.0, 0.0, 0.0), (0.002, 0.002, 0.002)),
    "HEAD1": (0.20, (0.005, 0.0, 0.030), (0.0002, 0.0002, 0.0002)),
}

# joint: axis, offset of its frame from the parent's m, range deg, torque limit N m, gear ratio, armature kg m²
JOINTS: dict[str, tuple[str, Vector, tuple[float, float], float, float, float]] = {
    "RLEG0": ("z", (0.0, -0.060, 0.0), (-45, 30), 250, 384, 1.0),
    "RLEG1": ("x", (0.0, 0.0, 0.0), (-35, 20), 250, 240, 0.40),
    "RLEG2": ("y", (0.0, 0.0, 0.0), (-125, 42), 250, 180, 0.43),
    "RLEG3": ("y", (0.0, 0.0, -0.300), (-2, 150), 250, 200, 0.54),
    "RLEG4": ("y", (0.0, -0.035, -0.300), (-75, 42), 250, 180, 0.23),
    "RLEG5": ("x", (0.0, 0.0, 0.0), (-20, 35), 250, 100, 0.07),
    "CHEST0": ("z", (0.032, 0.0, 0.3477), (-45, 45), 100, 207.7, 0.30),
    "CHEST1": ("y", (0.0, 0.0, 0.0), (-5, 60), 250, 381.5, 1.0),
    "CHEST2": ("x", (0.0, 0.0, 0.0), (-20, 20), 250, 240, 0.40),
    "HEAD0": ("z", (-0.007, 0.0, 0.2973), (-45, 45), 50, 100, 0.1),
    "HEAD1": ("y", (0.0, 0.0, 0.0), (-30, 45), 50, 100, 0.1),
    "HEAD2": ("x", (0.0, 0.0, 0.0), (-30, 30), 50, 100, 0.1),
    "RARM0": ("y", (0.008, -0.250, 0.181), (-180, 60), 100, 219.2, 0.33),
    "RARM1": ("x", (0.0, 0.0, 0.0), (-95, 10), 100, 231.3, 0.33),
    "RARM2": ("z", (0.0, 0.0, 0.0), (-92, 92), 100, 266.7, 0.33),
    "RARM3": ("y", (0.0, 0.0, -0.250), (-137, 2), 60, 250, 0.4),
    "RARM4": ("z", (0.0, 0.0, -0.250), (-92, 92), 50, 145.5, 0.1),
    "RARM5": ("y", (0.0, 0.0, 0.0), (-92, 92), 50, 350, 0.1),
    "RARM6": ("y", (0.022, 0.0, -0.09), (-60, 16), 20, 200, 0.02),
}

LOSSES = {"strong": (0.5, 0.3), "light": (0.2, 0.1)}  # damping N m s/rad, friction loss N m
MOTOR_SPEED = 7500 * 2 * pi / 60  # rad/s, estimated: HRP-2's velocity limits are not public
ACCELERATION, ACCELERATION_HARD = 60.0, 400.0  # rad/s²: for references and braking; bound of a tick

LEG_REST_ANGLES = {2: -0.453786, 3: 0.872665, 4: -0.418879}
RIGHT_ARM_REST_ANGLES = (0.2618, -0.1745, 0.0, -0.5236, 0.0, 0.0, 0.1)

# Points named on the right side or in the middle. The knee point lies on the knee axis where hip, knee and ankle of
# a stretched leg are in line; the palm belongs to the wrist's link, so that closing the gripper does not move it.
POINTS: dict[str, dict[str, Vector]] = {
    "BODY": {"waist": (0.0, 0.0, 0.0)},
    "CHEST": {"chest": (0.0, 0.0, 0.0), "neck": JOINTS["HEAD0"][1]},
    "HEAD": {"head": (0.0, 0.0, 0.0), "head_top": (0.0, 0.0, 0.19)},
    "RLEG0": {"right_hip": (0.0, 0.0, 0.0)},
    "RLEG3": {"right_knee": (0.0, -0.0175, 0.0)},
    "RLEG5": {
        "right_ankle": (0.0, 0.0, 0.0),
        "right_foot": (0.0, 0.0, SOLE_Z),
        "right_toe": (SOLE_X[1], 0.0, SOLE_Z),
    },
    "RARM0": {"right_shoulder": (0.0, 0.0, 0.0)},
    "RARM3": {"right_elbow": (0.0, 0.0, 0.0)},
    "RARM4": {"right_wrist": (0.0, 0.0, 0.0)},
    "RARM5": {"right_hand": (0.0, 0.0, -0.10)},
}

WAIST, CHEST, HEAD, RIGHT_ARM, LEFT_ARM, RIGHT_LEG, LEFT_LEG = (1 << k for k in range(7))
# (own bit, bits it meets); neighbours that overlap by design, as thigh and waist, are not listed
CONTACTS = {
    "BODY": (WAIST, 0),
    "CHEST": (CHEST, 0),
    "HEAD": (HEAD, 0),
    "RARM": (RIGHT_ARM, WAIST | CHEST | HEAD | LEFT_ARM | RIGHT_LEG | LEFT_LEG),
    "LARM": (LEFT_ARM, WAIST | CHEST | HEAD | RIGHT_ARM | RIGHT_LEG | LEFT_LEG),
    "RLEG": (RIGHT_LEG, CHEST | HEAD | LEFT_LEG),
    "LLEG": (LEFT_LEG, CHEST | HEAD | RIGHT_LEG),
}

CORNERS = {  # right sole, in the foot frame, going round
    "right_sole_front_out": (SOLE_X[1], SOLE_Y[0]),
    "right_sole_front_in": (SOLE_X[1], SOLE_Y[1]),
    "right_sole_back_in": (SOLE_X[0], SOLE_Y[1]),
    "right_sole_back_out": (SOLE_X[0], SOLE_Y[0]),
}

# Rubber pads of the right hand in its frame: middle, and two edges [pad sides] whose product points out of the hand.
# Nearer than 52 mm to its axis, or 12 mm to its end, the hand itself would touch first.
PAD_SIDE, PAD_FRICTION = 0.07, 0.6  # m; the coefficient that is relied upon
PADS: dict[str, tuple[Vector, Vector, Vector]] = {
    "right_palm": ((0.0, 0.052, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "right_hand_end": ((0.0, 0.0, -0.072), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)),
    # On the thumb's side, 3 cm of the hand's length: narrower than the handles that hang on it.
    "right_hook": ((0.052, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 3.0 / 7.0)),
}


def _joint_from_table(name: str) -> Joint:
    axis, _, limits, torque, gear, armature = JOINTS[name]
    losses = "strong" if name.startswith(("RLEG", "CHEST")) else "light"
    return Joint(name, axis, radians(limits[0]), radians(limits[1]), torque, gear, armature, losses)


def _link_from_table(name: str, parent: str | None) -> Link:
    body = MassProperties.diagonal(*MASSES[name])
    if name in COVERS:
        body = body + MassProperties.diagonal(*COVERS[name])
    contact, collides = CONTACTS[name.rstrip("0123456789")]
    offset = JOINTS[name][1] if parent else (0.0, 0.0, 0.0)
    sites = dict(POINTS.get(name, {}))
    if name == "RLEG5":
        sites |= {corner: (x, y, SOLE_Z) for corner, (x, y) in CORNERS.items()}
    joint = _joint_from_table(name) if parent else None
    shapes, collision = VISUAL[name], COLLISION.get(name, ())
    return Link(
        f"{name}_LINK" if parent else name, parent, offset, body, joint, shapes, collision, contact, collides, sites
    )


def _chain_links(prefix: str, count: int, parent: str) -> Iterator[Link]:
    for k in range(count):
        link = _link_from_table(f"{prefix}{k}", parent)
        yield link
        parent = link.name


def _mirrored(link: Link) -> Link:
    def left(name: str) -> str:
        return "L" + name[1:] if name.startswith(("RLEG", "RARM")) else name.replace("right_", "left_")

    contact, collides = CONTACTS[left(link.name)[:4]]
    return Link(
        left(link.name),
        left(link.parent) if link.parent else None,
        mjcf.mirror(link.offset),
        link.body.mirrored(),
        link.joint.mirrored(left(link.joint.name)) if link.joint else None,
        tuple(s.mirrored() for s in link.shapes),
        tuple(s.mirrored() for s in link.collision),
        contact,
        collides,
        {left(name): mjcf.mirror(at) for name, at in link.sites.items()},
    )


def _with_roll(chain: list[Link]) -> list[Link]:
    """The chain with a roll joint before its last link, whose mass is shared between the two."""
    *before, last = chain
    name = last.name.removesuffix("_LINK")
    cut = MassProperties.diagonal(*CUT_FOR_ROLL[name])
    carrier = replace(last, body=cut, shapes=last.shapes[:1], collision=(), sites={})
    roll = _joint_from_table(f"{name[:-1]}2")
    end = replace(
        last,
        name=f"{roll.name}_LINK",
        parent=carrier.name,
        offset=(0.0, 0.0, 0.0),
        body=last.body - cut,
        joint=roll,
        shapes=last.shapes[1:],
    )
    return [*before, carrier, end]


def links(modified: bool = False) -> list[Link]:
    """The tree, base first, in the order RLEG, LLEG, CHEST, HEAD, RARM, LARM."""
    right_leg = list(_chain_links("RLEG", 6, "BODY"))
    chest = list(_chain_links("CHEST", 2, "BODY"))
    chest = _with_roll(chest) if modified else chest
    chest[-1] = replace(chest[-1], sites=POINTS["CHEST"])
    head = list(_chain_links("HEAD", 2, chest[-1].name))
    head = _with_roll(head) if modified else head
    head[-1] = replace(head[-1], sites=POINTS["HEAD"])
    right_arm = list(_chain_links("RARM", 7, chest[-1].name))
    return [
        _link_from_table("BODY", None),
        *right_leg,
        *map(_mirrored, right_leg),
        *chest,
        *head,
        *right_arm,
        *map(_mirrored, right_arm),
    ]


def half_sitting_configuration(joints: Sequence[Joint]) -> list[float]:
    """Configuration in MuJoCo's order, the soles flat and on z = 0."""
    angles = {f"{side}LEG{k}": angle for side in "RL" for k, angle in LEG_REST_ANGLES.items()}
    for k, angle in enumerate(RIGHT_ARM_REST_ANGLES):
        angles[f"RARM{k}"] = angle
        angles[f"LARM{k}"] = angle if JOINTS[f"RARM{k}"][0] == "y" else -angle
    thigh, shank = -JOINTS["RLEG3"][1][2], -JOINTS["RLEG4"][1][2]
    height = thigh * cos(LEG_REST_ANGLES[2]) + shank * cos(LEG_REST_ANGLES[2] + LEG_REST_ANGLES[3]) - SOLE_Z
    return [0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0, *(angles.get(j.name, 0.0) for j in joints)]


def model_text(name: str, tree: Sequence[Link]) -> str:
    """The MJCF file."""
    joints = [link.joint for link in tree if link.joint]
    note = "HRP-2-like humanoid, written by sot.robots.models.hrp2: change its tables, not this file"
    return mjcf.mjcf_text(name, tree, LOSSES, LOOKS, ("half_sitting", half_sitting_configuration(joints)), note)


def _surface_text(surface: str, left: bool) -> list[str]:
    """A pad of a hand in the robot file: corners counter-clockwise seen from outside."""
    middle, first, second = PADS[surface]
    around = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    corners: list[Vector] = []
    for a, b in around:
        x, y, z = (round(m + PAD_SIDE * (a * u + b * v), 6) for m, u, v in zip(middle, first, second, strict=True))
        corners.append((x, y, z))
    if left:
        corners = [mjcf.mirror(corner) for corner in reversed(corners)]
    side = "left" if left else "right"
    return [
        f"[surfaces.{surface.replace('right', side)}]",
        f'point = "{side}_hand"',
        f"corners = [{', '.join(str([x + 0.0 for x in corner]) for corner in corners)}]",
        f"friction = {PAD_FRICTION}",
        "",
    ]


def robot_text(name: str, label: str, tree: Sequence[Link]) -> str:
    """The robot file (TOML) beside the model."""
    joints = [link.joint for link in tree if link.joint]
    points = [site for link in tree for site in link.sites if "_sole_" not in site]
    groups = {
        "right_leg": "RLEG",
        "left_leg": "LLEG",
        "chest": "CHEST",
        "head": "HEAD",
        "right_arm": "RARM",
        "left_arm": "LARM",
    }
    lines = [
        "# Written by sot.robots.models.hrp2: change its tables, not this file.",
        f'label = "{label}"',
        f'model = "{name}.xml"',
        'rest = "half_sitting"              # a key frame of the model',
        "",
        "[points]                           # name = frame of the model",
        *(f'{point} = "{point}"' for point in points),
        "",
        "[soles]                            # corners: frames of the model",
        *(f"{side}_foot = {_string_list(c.replace('right', side) for c in CORNERS)}" for side in ("left", "right")),
        "",
        *(line for left in (False, True) for surface in PADS for line in _surface_text(surface, left)),
        "[groups]",
        *(f"{group} = {_string_list(j.name for j in joints if j.name.startswith(p))}" for group, p in groups.items()),
        "",
        "[limits]",
        f"acceleration = {ACCELERATION}              # rad/s², for references and braking",
        f"acceleration_hard = {ACCELERATION_HARD}        # rad/s², bound of a tick",
        "",
        "[limits.velocity]                  # rad/s: a motor of 7,500 rpm through the joint's gear",
        *(f"{j.name} = {MOTOR_SPEED / j.gear_ratio:.3f}" for j in joints),
    ]
    return "\n".join(lines) + "\n"


def _string_list(names: Iterator[str]) -> str:
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


def file_texts() -> dict[str, str]:
    """File name -> text of all four files."""
    out = {}
    for name, label, modified in (("hrp2", "HRP-2-like", False), ("hrp2_modified", "HRP-2-like, modified", True)):
        tree = links(modified)
        out[f"{name}.xml"] = model_text(name, tree)
        out[f"{name}.toml"] = robot_text(name, label, tree)
    return out


if __name__ == "__main__":
    for file_name, content in file_texts().items():
        (Path(__file__).parent / file_name).write_text(content, encoding="utf-8")
