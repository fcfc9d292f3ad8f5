"""Small humanoids to guess from: a trunk that may sit on a waist joint, legs, arms that may stick out, and no names."""

from itertools import count

FOOT = {
    "box": '<geom type="box" size="0.1 0.05 0.02" pos="0.03 0 -0.06"/>',
    "spheres": "".join(
        f'<geom type="sphere" size="0.02" pos="{x} {y} -0.06"/>' for x in (-0.05, 0.11) for y in (-0.04, 0.04)
    ),
    "capsules": "".join(
        f'<geom type="capsule" size="0.02" fromto="-0.05 {y} -0.06 0.11 {y} -0.06"/>' for y in (-0.04, 0.04)
    ),
}


def humanoid(
    *,
    waist_first: bool = False,
    t_pose: bool = False,
    foot: str = "box",
    turn_deg: float = 0.0,
    leg_joints: int = 6,
    fingers: str = "",
    extra: str = "",
    motors: bool = True,
    fixed: bool = False,
) -> str:
    """An MJCF whose joints are called j0, j1, … in the order in which they are met."""
    numbers = count()
    names: list[str] = []

    def joint(axis: str, low: float, high: float) -> str:
        names.append(f"j{next(numbers)}")
        return f'<joint name="{names[-1]}" axis="{axis}" range="{low} {high}" armature="0.02"/>'

    def link(at: str, inside: str, geom: str) -> str:
        return f'<body pos="{at}"><inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>{inside}{geom}</body>'

    def leg(side: float) -> str:
        hip = joint("0 0 1", -0.8, 0.8) + joint("1 0 0", -0.6, 0.6) + joint("0 1 0", -2.0, 0.8)
        knee = joint("0 1 0", -0.03, 2.5)
        ankle = joint("0 1 0", -1.2, 0.7) + (joint("1 0 0", -0.4, 0.4) if leg_joints == 6 else "")
        thigh, shank = (f'<geom type="capsule" size="0.03" fromto="0 0 -0.08 0 0 -{end}"/>' for end in (0.22, 0.2))
        sole = link("0 0 -0.3", ankle, FOOT[foot])
        return link(f"0 {0.1 * side} -0.1", hip, thigh + link("0 0 -0.3", knee, shank + sole))

    def arm(side: float) -> str:
        way = f"0 {side} 0" if t_pose else "0 0 -1"
        upper, lower = (" ".join(str(0.25 * float(x)) for x in way.split()), way)
        shoulder = joint("0 1 0", -3.0, 3.0) + joint("1 0 0", -3.0, 3.0) + joint(way, -2.0, 2.0)
        elbow = joint("0 0 1" if t_pose else "0 1 0", -2.4, 2.4)
        hand = " ".join(str(0.25 * float(x)) for x in lower.split())
        bone = f'<geom type="capsule" size="0.03" fromto="0 0 0 {hand}"/>'
        return link(f"0 {0.25 * side} 0.4", shoulder, bone + link(upper, elbow, bone + fingers.format(at=hand)))

    base = "" if fixed else "<freejoint/>"
    chest = f'<geom type="box" size="0.08 0.15 0.1" pos="0 0 0.35"/>{arm(1.0)}{arm(-1.0)}'
    head = link(
        "0 0 0.55", joint("0 0 1", -1, 1) + joint("0 1 0", -1, 1), '<geom type="sphere" size="0.1" pos="0 0 0.1"/>'
    )
    legs = f'<geom type="box" size="0.06 0.1 0.03"/>{leg(1.0)}{leg(-1.0)}'
    waist = joint("0 0 1", -1.5, 1.5)
    if waist_first:
        body = base + chest + head + link("0 0 0", waist, legs)
    else:
        body = base + legs + link("0 0 0.1", waist, (chest + head).replace("0 0 0.35", "0 0 0.25"))
    drive = "".join(f'<motor joint="{name}" ctrlrange="-80 80"/>' for name in names) if motors else ""
    return f"""<mujoco model="toy"><compiler angle="radian" autolimits="true"/><worldbody>
        <body euler="0 0 {turn_deg * 3.141592653589793 / 180}"><inertial pos="0 0 0.2" mass="10" diaginertia="1 1 1"/>
        {body}</body></worldbody><actuator>{drive}</actuator>{extra}</mujoco>"""
