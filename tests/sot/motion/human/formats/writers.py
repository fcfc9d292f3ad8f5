"""Writers of the formats that people bring, made for tests from public descriptions: none shares code with a reader."""

import struct
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from tests.sot.motion.human.formats.dance import Dance

Z_UP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # from X left, Y up, Z forward to X forward, Z up
Y_TO_Z = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # AMASS's: about X, which stays

SMPL_OF = {
    **dict(
        zip(
            ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"),
            ("Pelvis", "Spine1", "Spine2", "Spine3", "Neck", "Head"),
            strict=True,
        )
    ),
    **{
        f"{side}{ours}": f"{side[0]}_{theirs}"
        for side in ("Left", "Right")
        for ours, theirs in (
            ("Shoulder", "Collar"),
            ("Arm", "Shoulder"),
            ("ForeArm", "Elbow"),
            ("Hand", "Wrist"),
            ("UpLeg", "Hip"),
            ("Leg", "Knee"),
            ("Foot", "Ankle"),
            ("ToeBase", "Foot"),
        )
    },
}
SMPL_ORDER = (
    *("Pelvis", "L_Hip", "R_Hip", "Spine1", "L_Knee", "R_Knee", "Spine2", "L_Ankle", "R_Ankle", "Spine3", "L_Foot"),
    *("R_Foot", "Neck", "L_Collar", "R_Collar", "Head", "L_Shoulder", "R_Shoulder", "L_Elbow", "R_Elbow", "L_Wrist"),
    "R_Wrist",
)


def amass_arrays(dance: Dance, kind: str = "smplh") -> dict[str, np.ndarray]:
    """What AMASS stores of a dance: "smplh" or "smplx", which name the rate differently, or "parts"."""
    poses = np.zeros((dance.count, len(SMPL_ORDER), 3))
    for j, name in enumerate(dance.joints):
        turn = Rotation.from_quat(dance.turns[:, j])
        if dance.parents[j] < 0:
            turn = Rotation.from_matrix(Y_TO_Z) * turn
        poses[:, SMPL_ORDER.index(SMPL_OF[name])] = turn.as_rotvec()
    body = poses.reshape(dance.count, -1)
    common = {"trans": dance.place @ Y_TO_Z.T, "betas": np.zeros(16), "gender": np.array("neutral")}
    if kind == "parts":
        parts = {"root_orient": body[:, :3], "pose_body": body[:, 3:66], "pose_hand": np.zeros((dance.count, 90))}
        return common | parts | {"mocap_frame_rate": np.array(dance.rate)}
    width, rate = (156, "mocap_framerate") if kind == "smplh" else (165, "mocap_frame_rate")
    return common | {"poses": np.pad(body, ((0, 0), (0, width - 66))), rate: np.array(dance.rate)}


def write_amass(path: Path, dance: Dance, kind: str = "smplh") -> Path:
    np.savez(path, **amass_arrays(dance, kind))
    return path


SEGMENTS = {
    **dict(
        zip(
            ("Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head"),
            ("Hips", "Spine", "Spine1", "Spine2", "", "Neck", "Head"),
            strict=True,
        )
    ),
    **{
        side + theirs: side + ours
        for side in ("Right", "Left")
        for theirs, ours in (
            ("Shoulder", "Shoulder"),
            ("UpperArm", "Arm"),
            ("ForeArm", "ForeArm"),
            ("Hand", "Hand"),
            ("UpperLeg", "UpLeg"),
            ("LowerLeg", "Leg"),
            ("Foot", "Foot"),
            ("Toe", "ToeBase"),
        )
    },
}
LIMBS = ("Shoulder", "UpperArm", "ForeArm", "Hand"), ("UpperLeg", "LowerLeg", "Foot", "Toe")


def mvnx_text(dance: Dance, joints: bool = True, wxyz: bool = True) -> str:
    """A dance as the text of an MVNX: with or without its list of joints; quaternions in the right order or not."""
    positions, rotations = dance.world()
    frames = []
    still = Dance(dance.joints, dance.parents, dance.offsets, dance.place[:1], 0 * dance.turns[:1] + [0, 0, 0, 1], {})

    def numbers(values: np.ndarray) -> str:
        return " ".join(f"{value:.6f}" for value in values.ravel())

    def frame(places: np.ndarray, turns: np.ndarray, kind: str, index: int) -> str:
        place, quaternion = [], []
        for segment, ours in SEGMENTS.items():
            j = dance.joints.index(ours or "Spine2")
            here = places[j] + (turns[j] @ [0.0, 0.06, 0.0] if segment == "T8" else 0.0)
            place.append(Z_UP @ here)
            turn = Rotation.from_matrix(Z_UP @ turns[j] @ Z_UP.T)
            quaternion.append(turn.as_quat(scalar_first=wxyz))
        return (
            f'<frame time="{1000 * index / dance.rate:.0f}" index="{index}" tc="00:00:00:00" ms="0" type="{kind}">\n'
            f"<orientation>{numbers(np.array(quaternion))}</orientation>\n"
            f"<position>{numbers(np.array(place))}</position>\n</frame>"
        )

    rest, turned = still.world()
    frames.append(frame(rest[0], turned[0], "identity", 0))
    frames += [frame(positions[t], rotations[t], "normal", t) for t in range(dance.count)]
    labels = list(SEGMENTS)
    spine = labels[:7]
    pairs = list(pairwise(spine))
    for side in ("Right", "Left"):
        for carrier, limb in zip(("T8", "Pelvis"), LIMBS, strict=True):
            chain = [carrier, *(side + part for part in limb)]
            pairs += list(pairwise(chain))
    listed = "".join(
        f'<joint label="j{b}"><connector1>{a}/j{b}</connector1><connector2>{b}/j{b}</connector2></joint>\n'
        for a, b in pairs
    )
    segments = "".join(
        f'<segment label="{label}" id="{k + 1}"><points><point><pos_b>0 0 0</pos_b></point></points></segment>\n'
        for k, label in enumerate(labels)
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<mvnx version="4" xmlns="http://www.xsens.com/mvn/mvnx">\n'
        f'<mvn version="2020"/>\n<subject label="A" frameRate="{dance.rate:g}" segmentCount="{len(labels)}">\n'
        f"<segments>\n{segments}</segments>\n<joints>\n{listed if joints else ''}</joints>\n"
        f'<frames segmentCount="{len(labels)}">\n' + "\n".join(frames) + "\n</frames></subject></mvnx>\n"
    )


def markers(dance: Dance, style: str = "plug_in_gait", inner: bool = False) -> dict[str, np.ndarray]:
    """Markers (T, 3) on the skin of a dancer [m], Z up: "plug_in_gait" or "optitrack"."""
    positions, rotations = dance.world()
    index = dance.joints.index

    def on(joint: str, x: float, y: float, z: float) -> np.ndarray:
        """A place on a body by its joint: left, up, forward [m]."""
        return positions[:, index(joint)] + rotations[:, index(joint)] @ np.array([x, y, z])

    found: dict[str, np.ndarray] = {}
    for sign, side in ((1.0, "Left"), (-1.0, "Right")):
        letter = side[0]
        pig = {
            f"{letter}ASI": on("Hips", sign * 0.125, 0.083, 0.05),
            f"{letter}PSI": on("Hips", sign * 0.05, 0.09, -0.11),
            f"{letter}SHO": on("Spine2", sign * 0.18, 0.16 + 0.06, 0.0),
            f"{letter}ELB": on(f"{side}ForeArm", 0.0, 0.043, 0.0),
            f"{letter}WRA": on(f"{side}Hand", 0.0, 0.0, 0.03),
            f"{letter}WRB": on(f"{side}Hand", 0.0, 0.0, -0.03),
            f"{letter}KNE": on(f"{side}Leg", sign * 0.055, 0.0, 0.0),
            f"{letter}ANK": on(f"{side}Foot", sign * 0.04, 0.0, 0.0),
            f"{letter}HEE": on(f"{side}Foot", 0.0, -0.06, -0.06),
            f"{letter}TOE": on(f"{side}ToeBase", 0.0, 0.01, 0.0),
            f"{letter}FHD": on("Head", sign * 0.07, 0.09, 0.09),
            f"{letter}BHD": on("Head", sign * 0.07, 0.09, -0.08),
        }
        if inner:
            pig[f"{letter}KNM"] = on(f"{side}Leg", -sign * 0.055, 0.0, 0.0)
            pig[f"{letter}ANM"] = on(f"{side}Foot", -sign * 0.04, 0.0, 0.0)
        found |= pig
    found |= {
        "C7": on("Neck", 0.0, 0.0, -0.06),
        "CLAV": on("Neck", 0.0, -0.04, 0.06),
        "STRN": on("Spine2", 0.0, 0.02, 0.1),
        "T10": on("Spine2", 0.0, 0.0, -0.1),
    }
    if style == "optitrack":
        names = {"ELB": "ElbowOut", "WRA": "WristIn", "WRB": "WristOut", "KNE": "KneeOut", "ANK": "AnkleOut"}
        names |= {"SHO": "ShoulderTop", "HEE": "HeelBack", "TOE": "ToeIn"}
        renamed = {"CLAV": "Chest", "C7": "BackTop", "STRN": "BackLeft", "T10": "BackRight"}
        renamed |= {"LFHD": "HeadFront", "RFHD": "HeadSide", "LBHD": "HeadTop", "RBHD": "HeadBack"}
        for letter in "LR":
            renamed |= {f"{letter}ASI": f"Waist{letter}Front", f"{letter}PSI": f"Waist{letter}Back"}
            renamed |= {letter + ours: letter + theirs for ours, theirs in names.items()}
        found = {renamed.get(name, name): place for name, place in found.items()}
    return {name: place @ Z_UP.T for name, place in found.items()}


def c3d_bytes(
    points: dict[str, np.ndarray],
    rate: float,
    whole: bool = False,
    big: bool = False,
    vax: bool = False,
    unit: str = "mm",
) -> bytes:
    """Points (T, 3) [m], nan where they are not seen, as the bytes of a C3D.

    whole: in whole numbers instead of real ones; big: of a processor with the high byte first; vax: of DEC's.
    """
    order = ">" if big else "<"
    per_metre = {"mm": 1000.0, "m": 1.0}[unit]
    places = per_metre * np.stack(list(points.values()), axis=1)
    frames, count = places.shape[:2]
    scale = 0.1 if whole else -1.0

    def real(value: float) -> bytes:
        if not vax:
            return struct.pack(order + "f", value)
        raw = struct.pack("<f", 4.0 * value)
        return raw[2:] + raw[:2]

    def group(number: int, name: str) -> bytes:
        return struct.pack("bb", len(name), -number) + name.encode() + struct.pack(order + "h", 3) + b"\0"

    def parameter(number: int, name: str, kind: int, sizes: list[int], data: bytes) -> bytes:
        body = struct.pack("bB", kind, len(sizes)) + bytes(sizes) + data + b"\0"
        return struct.pack("bb", len(name), number) + name.encode() + struct.pack(order + "h", len(body) + 2) + body

    width = max(map(len, points)) + 4
    labels = "".join(f"Ann:{name}".ljust(width) for name in points).encode()
    sections = (
        group(1, "POINT")
        + parameter(1, "USED", 2, [], struct.pack(order + "h", count))
        + parameter(1, "SCALE", 4, [], real(scale))
        + parameter(1, "RATE", 4, [], real(rate))
        + parameter(1, "FRAMES", 2, [], struct.pack(order + "h", frames))
        + parameter(1, "UNITS", -1, [len(unit)], unit.encode())
        + parameter(1, "LABELS", -1, [width, count], labels)
        + b"\0\0"
    )
    blocks = -(-(len(sections) + 4) // 512)
    start = 2 + blocks
    head = bytearray(512)
    head[0:2] = b"\x02\x50"
    struct.pack_into(order + "HHHHH", head, 2, count, 0, 1, frames, 10)
    head[12:16] = real(scale)
    struct.pack_into(order + "HH", head, 16, start, 0)
    head[20:24] = real(rate)
    parameters = (bytes([1, 0x50, blocks, 86 if big else 85 if vax else 84]) + sections).ljust(512 * blocks, b"\0")
    lost = np.isnan(places[:, :, 0])
    if whole:
        values = np.dstack([np.where(lost[..., None], 0.0, places / scale), np.where(lost, -1, 0)])
        data = np.round(values).astype(order + "i2").tobytes()
    else:
        values = np.dstack([np.where(lost[..., None], 0.0, places), np.where(lost, -1.0, 0.0)])
        data = b"".join(map(real, values.ravel())) if vax else values.astype(order + "f4").tobytes()
    return bytes(head) + parameters + data.ljust(-(-len(data) // 512) * 512, b"\0")


def renamed_bvh(
    dance: Dance,
    names: dict[str, str],
    order: str = "ZXY",
    everywhere: bool = False,
    turned: bool = False,
    root: str = "",
    six: bool = False,
    split: dict[str, str] | None = None,
    values_order: str = "",
) -> str:
    """A dance as a .bvh of another program.

    names: our joint -> theirs; a tip without a name is an end site.
    order: of the rotation channels.
    everywhere: joints have position channels.
    turned: each joint has its axes in another order, as where they lie along bones: the zero pose is none.
    root: name of a joint at the origin above all.
    six: OFFSETs have angles behind them.
    split: joint -> name of one more in the middle of its bone.
    values_order: in which the angles are made, if other than what the file says.
    """
    random = np.random.default_rng(7)
    own = Rotation.identity(len(dance.joints))
    if turned:
        own = Rotation.create_group("O")[random.integers(24, size=len(dance.joints))]
    lines, columns = ["HIERARCHY"], []
    children: dict[int, list[int]] = {}
    for j, parent in enumerate(dance.parents):
        children.setdefault(parent, []).append(j)

    def offset(values: np.ndarray) -> str:
        return "OFFSET " + " ".join(f"{value:.5f}" for value in values) + (" 1.5 0.25 -3.0" if six else "")

    def channels(places: bool) -> str:
        listed = ([f"{axis}position" for axis in "XYZ"] if places else []) + [f"{axis}rotation" for axis in order]
        return f"CHANNELS {len(listed)} {' '.join(listed)}"

    def angles(turn: Rotation) -> np.ndarray:
        made = turn.as_euler(values_order or order, degrees=True)
        return made[:, [(values_order or order).index(axis) for axis in order]]

    def write(j: int, depth: int) -> None:
        pad = "  " * depth
        parent = dance.parents[j]
        above = own[parent].inv() if parent >= 0 else Rotation.identity()
        place = 100.0 * (above.apply(dance.offsets[j]) if parent >= 0 else np.zeros(3))
        name = names.get(dance.joints[j], f"x{j}")
        half = (split or {}).get(dance.joints[dance.parents[j]] if parent >= 0 else "")
        if half:
            lines.extend(
                [f"{pad}JOINT {half}", pad + "{", pad + "  " + offset(0.5 * place), pad + "  " + channels(False)]
            )
            columns.append(np.zeros((dance.count, 3)))
            place, depth, pad = 0.5 * place, depth + 1, pad + "  "
        title = "ROOT" if depth == 0 else "JOINT"
        lines.extend([f"{pad}{title} {name}", pad + "{", pad + "  " + offset(place)])
        lines.append(pad + "  " + channels(parent < 0 or everywhere))
        if parent < 0:
            columns.append(100.0 * dance.place)
        elif everywhere:
            columns.append(np.tile(place, (dance.count, 1)))
        columns.append(angles(above * Rotation.from_quat(dance.turns[:, j]) * own[j]))
        below = [child for child in children.get(j, []) if dance.joints[child] in names or child in children]
        for child in below:
            write(child, depth + 1)
        if not below:
            tip = dance.tips.get(dance.joints[j])
            if tip is None:
                tip = dance.offsets[children[j][0]]
            end = 100.0 * own[j].inv().apply(tip)
            lines.extend([f"{pad}  End Site", pad + "  {", pad + "    " + offset(end), pad + "  }"])
        lines.append(pad + "}")
        if half:
            lines.append(pad[2:] + "}")

    if root:
        lines.extend([f"ROOT {root}", "{", "  " + offset(np.zeros(3)), "  " + channels(True)])
        columns.append(np.zeros((dance.count, 6)))
    write(0, 1 if root else 0)
    if root:
        lines.append("}")
    rows = [" ".join(f"{value:.5f}" for value in row) for row in np.concatenate(columns, axis=1)]
    return "\n".join([*lines, "MOTION", f"Frames: {len(rows)}", f"Frame Time: {1 / dance.rate:.7f}", *rows, ""])
