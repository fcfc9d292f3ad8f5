"""What the HRP-2-like robot looks like and what it collides with: primitive shapes in link frames [m], right side.

Our own drawing. The leg links hang outside their hip joint, as their centres of mass say. White shells over dark
blue, grey where something turns.
"""

from dataclasses import replace

from sot.robots.models.mjcf import Shape, Vector

LOOKS = {
    "white": (0.92, 0.92, 0.94),
    "grey": (0.45, 0.47, 0.50),
    "dark": (0.14, 0.15, 0.18),
    "blue": (0.10, 0.18, 0.42),
    "visor": (0.03, 0.05, 0.10),
}

# Sole in the ankle frame (right foot): x, y and height.
SOLE_X = (-0.100, 0.130)
SOLE_Y = (-0.075, 0.056)
SOLE_Z = -0.105
SOLE_THICKNESS = 0.02

_SOLE = Shape(
    "box",
    ((SOLE_X[1] - SOLE_X[0]) / 2, (SOLE_Y[1] - SOLE_Y[0]) / 2, SOLE_THICKNESS / 2),
    (sum(SOLE_X) / 2, sum(SOLE_Y) / 2, SOLE_Z + SOLE_THICKNESS / 2),
)


def box(at: Vector, half: Vector, look: str, tilt: float = 0.0) -> Shape:
    return Shape("box", half, at, None, look, tilt)


def ellipsoid(at: Vector, radii: Vector, look: str, tilt: float = 0.0) -> Shape:
    return Shape("ellipsoid", radii, at, None, look, tilt)


def ball(at: Vector, radius: float, look: str) -> Shape:
    return Shape("sphere", (radius,), at, None, look)


def capsule(at: Vector, to: Vector, radius: float, look: str = "") -> Shape:
    return Shape("capsule", (radius,), at, to, look)


def cylinder(at: Vector, to: Vector, radius: float, look: str) -> Shape:
    return Shape("cylinder", (radius,), at, to, look)


VISUAL: dict[str, tuple[Shape, ...]] = {
    "BODY": (
        box((-0.005, 0.0, 0.05), (0.07, 0.085, 0.055), "dark"),
        capsule((-0.015, -0.075, 0.085), (-0.015, 0.075, 0.085), 0.065, "white"),
        box((0.055, 0.0, 0.06), (0.03, 0.05, 0.05), "blue", 0.25),
        capsule((-0.01, -0.035, 0.15), (-0.01, 0.035, 0.15), 0.08, "dark"),
        box((-0.01, 0.0, 0.215), (0.07, 0.105, 0.055), "white"),
        capsule((0.035, -0.055, 0.215), (0.035, 0.055, 0.215), 0.05, "white"),
        box((-0.09, 0.0, 0.205), (0.025, 0.085, 0.055), "grey"),
        cylinder((0.015, 0.0, 0.27), (0.015, 0.0, 0.30), 0.09, "dark"),
    ),
    "CHEST0": (cylinder((0.0, 0.0, -0.05), (0.0, 0.0, -0.012), 0.072, "grey"),),
    "CHEST1": (
        cylinder((0.0, -0.095, 0.0), (0.0, 0.095, 0.0), 0.05, "dark"),
        box((-0.025, 0.0, 0.075), (0.065, 0.095, 0.05), "dark"),
        box((0.03, 0.0, 0.075), (0.03, 0.085, 0.045), "white", 0.3),
        box((-0.03, 0.0, 0.165), (0.075, 0.135, 0.058), "white"),
        capsule((0.04, -0.075, 0.165), (0.04, 0.075, 0.165), 0.058, "white"),
        box((0.086, 0.0, 0.165), (0.016, 0.028, 0.045), "blue", 0.1),
        box((-0.15, 0.0, 0.13), (0.05, 0.12, 0.11), "grey"),
        box((-0.155, 0.0, 0.13), (0.055, 0.09, 0.085), "dark"),
        capsule((0.0, -0.10, 0.185), (0.0, -0.205, 0.181), 0.05, "dark"),
        capsule((0.0, 0.10, 0.185), (0.0, 0.205, 0.181), 0.05, "dark"),
        cylinder((-0.007, 0.0, 0.22), (-0.007, 0.0, 0.25), 0.065, "blue"),
    ),
    "HEAD0": (cylinder((0.0, 0.0, -0.05), (0.0, 0.0, 0.0), 0.038, "dark"),),
    "HEAD1": (
        cylinder((0.0, -0.045, 0.0), (0.0, 0.045, 0.0), 0.035, "grey"),
        ellipsoid((0.0, 0.0, 0.105), (0.095, 0.08, 0.085), "white"),
        ellipsoid((0.02, 0.0, 0.045), (0.07, 0.06, 0.05), "white"),
        ellipsoid((0.045, 0.0, 0.095), (0.06, 0.07, 0.038), "visor"),
        box((0.072, 0.0, 0.152), (0.012, 0.02, 0.022), "blue", -0.5),
        cylinder((0.0, -0.088, 0.09), (0.0, -0.07, 0.09), 0.035, "blue"),
        cylinder((0.0, 0.07, 0.09), (0.0, 0.088, 0.09), 0.035, "blue"),
        box((-0.02, -0.083, 0.14), (0.014, 0.004, 0.05), "white", -0.35),
        box((-0.02, 0.083, 0.14), (0.014, 0.004, 0.05), "white", -0.35),
    ),
    "RLEG0": (cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.06), 0.05, "grey"),),
    "RLEG1": (cylinder((-0.075, -0.02, 0.0), (0.05, -0.02, 0.0), 0.045, "dark"),),
    "RLEG2": (
        ball((0.0, -0.035, -0.01), 0.066, "blue"),
        capsule((0.0, -0.042, -0.09), (0.0, -0.04, -0.20), 0.066, "white"),
        ellipsoid((0.022, -0.042, -0.13), (0.06, 0.062, 0.115), "white"),
        cylinder((0.0, -0.115, 0.0), (0.0, -0.095, 0.0), 0.05, "grey"),
    ),
    "RLEG3": (
        cylinder((0.0, -0.095, 0.0), (0.0, 0.02, 0.0), 0.052, "dark"),
        ellipsoid((0.035, -0.038, 0.0), (0.035, 0.05, 0.06), "blue"),
        capsule((0.005, -0.038, -0.08), (0.005, -0.037, -0.23), 0.05, "white"),
        ellipsoid((0.022, -0.038, -0.13), (0.052, 0.054, 0.10), "white"),
        ellipsoid((-0.022, -0.038, -0.12), (0.045, 0.048, 0.09), "grey"),
    ),
    "RLEG4": (
        cylinder((0.0, -0.045, 0.0), (0.0, 0.045, 0.0), 0.04, "dark"),
        cylinder((-0.055, 0.0, 0.0), (0.055, 0.0, 0.0), 0.03, "grey"),
    ),
    "RLEG5": (
        replace(_SOLE, look="dark"),
        box((0.0, -0.005, -0.07), (0.075, 0.05, 0.016), "white"),
        ellipsoid((0.065, -0.0095, -0.085), (0.06, 0.06, 0.032), "white"),
        ellipsoid((-0.05, -0.0095, -0.085), (0.045, 0.056, 0.03), "white"),
        box((0.0, -0.005, -0.045), (0.035, 0.03, 0.02), "blue"),
    ),
    "RARM0": (
        ball((0.0, 0.0, 0.0), 0.062, "dark"),
        cylinder((0.0, 0.03, 0.0), (0.0, 0.065, 0.0), 0.06, "blue"),
    ),
    "RARM1": (
        ellipsoid((0.0, -0.022, 0.022), (0.078, 0.062, 0.062), "white"),
        cylinder((0.0, 0.0, -0.02), (0.0, 0.0, -0.085), 0.042, "grey"),
    ),
    "RARM2": (
        capsule((0.0, 0.0, -0.11), (0.0, 0.0, -0.195), 0.048, "white"),
        box((0.0, -0.04, -0.15), (0.03, 0.012, 0.05), "blue"),
    ),
    "RARM3": (
        cylinder((0.0, -0.052, 0.0), (0.0, 0.052, 0.0), 0.043, "dark"),
        capsule((0.0, 0.0, -0.055), (0.0, 0.0, -0.11), 0.043, "white"),
    ),
    "RARM4": (
        cylinder((0.0, 0.0, 0.03), (0.0, 0.0, 0.115), 0.04, "blue"),
        capsule((0.0, 0.0, 0.03), (0.0, 0.0, 0.06), 0.042, "white"),
    ),
    "RARM5": (
        cylinder((0.0, -0.034, 0.0), (0.0, 0.034, 0.0), 0.028, "grey"),
        box((0.0, 0.0, -0.06), (0.027, 0.036, 0.035), "white"),
        box((-0.018, 0.0, -0.125), (0.008, 0.032, 0.032), "dark", 0.15),
    ),
    "RARM6": (
        cylinder((0.0, -0.03, 0.0), (0.0, 0.03, 0.0), 0.011, "grey"),
        box((0.002, 0.0, -0.033), (0.007, 0.026, 0.03), "dark", -0.15),
    ),
}

# Fewer and simpler than what is seen; they keep clear of each other over the ranges of the joints between them.
COLLISION: dict[str, tuple[Shape, ...]] = {
    "BODY": (
        capsule((-0.01, -0.07, 0.08), (-0.01, 0.07, 0.08), 0.075),
        capsule((-0.02, 0, 0.16), (-0.02, 0, 0.22), 0.11),
    ),
    "CHEST1": (
        Shape("box", (0.105, 0.14, 0.10), (-0.02, 0.0, 0.125)),
        Shape("box", (0.055, 0.12, 0.115), (-0.155, 0.0, 0.13)),
    ),
    "HEAD1": (Shape("sphere", (0.098,), (0.005, 0.0, 0.095)),),
    "RLEG2": (capsule((0.005, -0.042, -0.08), (0.005, -0.042, -0.22), 0.07),),
    "RLEG3": (capsule((0.005, -0.038, -0.02), (0.005, -0.037, -0.23), 0.06),),
    "RLEG5": (_SOLE,),
    "RARM2": (capsule((0.0, 0.0, -0.06), (0.0, 0.0, -0.21), 0.05),),
    "RARM3": (capsule((0.0, 0.0, 0.0), (0.0, 0.0, -0.20), 0.045),),
    "RARM5": (capsule((0.0, 0.0, -0.03), (0.0, 0.0, -0.12), 0.04),),
}
