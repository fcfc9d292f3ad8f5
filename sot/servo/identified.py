"""The identified pendulums of a robot, and what they were fitted to, in a file of text."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from sot.errors import InputError
from sot.servo.damping import PlaneDesigns
from sot.servo.pendulum import Pendulum
from sot.servo.pendulum_fit import FrequencyResponse
from sot.servo.pole_placement import MIN_MARGIN, checked_margin, design_damping
from sot.toml_file import is_number, read_toml
from sot.whole_file import atomic_write

PLANES, SUPPORTS = ("xz", "yz"), ("double", "single")
PARAMETERS = tuple(field.name for field in fields(Pendulum))
SERIES = ("frequency", "gain", "phase")
FOLDER = Path(__file__).parent / "pendulums"
HEAD = """\
# The robot as an inverted pendulum on a compliant joint, one for each plane and support: mass [kg], length from joint
# to centre of mass [m], stiffness [N m/rad], damping [N m s/rad], inertia about the centre of mass and the part of it
# that moves with the reference [kg m^2], lag and delay [s], share, frequency [rad/s] and damping ratio of the body's
# bending. They were fitted to the gain [m/rad] and phase [deg] of the zero-moment point over the angle of the
# reference, measured at frequencies [Hz]; a damping controller is refused if it is too near to oscillating on these.
"""


@dataclass(frozen=True)
class IdentifiedCase:
    """One plane on given feet: the pendulum, and the measured response that it was fitted to."""

    pendulum: Pendulum
    measured: FrequencyResponse


@dataclass(frozen=True)
class Identified:
    """What was identified of a robot.

    Attributes:
        robot: its name.
        bush: stiffness of its feet about x and y [N m/rad] and along z [N/m], where that is known; else nothing.
        cases: by plane and support.
    """

    robot: str
    bush: tuple[float, ...]
    cases: Mapping[tuple[str, str], IdentifiedCase]

    def designs(
        self, damping_ratio: float, period: float, form: str = "filtered", min_margin: float = MIN_MARGIN
    ) -> tuple[tuple[PlaneDesigns, PlaneDesigns], dict[str, float]]:
        """Damping controllers of both planes, and their margins on the measured responses by case.

        Where single support was not identified, the gains are those of double support; the other way round they would
        oscillate.

        Raises:
            InputError: a plane without double support, or a design that is refused, see `checked_margin`.
        """
        margins, planes = {}, []
        for plane in PLANES:
            if (plane, "double") not in self.cases:
                raise InputError(f"{self.robot}: double support was not identified in {plane}")
            found = {}
            for support in SUPPORTS:
                case = self.cases.get((plane, support))
                if case is not None:
                    design = design_damping(case.pendulum, damping_ratio, period, form)
                    name = f"{plane}-{support}"
                    margins[name] = checked_margin(design, case.measured, name, min_margin)
                    found[support] = design
            planes.append(PlaneDesigns(found["double"], found.get("single", found["double"])))
        return (planes[0], planes[1]), margins


def identified_robots() -> dict[str, Path]:
    """Files of the robots that come identified, by the robots' names."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}


def write_identified(path: Path, identified: Identified) -> None:
    """Write to a file (`.toml`), which appears once it is complete."""
    lines = [HEAD, f'robot = "{identified.robot}"']
    if identified.bush:
        lines.append(f"bush = {_numbers(identified.bush)}")
    for (plane, support), case in identified.cases.items():
        lines.append(f"\n[{plane}.{support}]")
        lines += [f"{name} = {value:.6g}" for name, value in asdict(case.pendulum).items()]
        frequency, value = case.measured
        series = (frequency, np.abs(value), np.rad2deg(np.angle(value)))
        lines += [f"{name} = {_numbers(row)}" for name, row in zip(SERIES, series, strict=True)]
    with atomic_write(path) as place:
        place.write_text("\n".join([*lines, ""]), encoding="utf-8")


def read_identified(path: Path) -> Identified:
    """Read what `write_identified` wrote, as someone may have edited it.

    Raises:
        InputError: not such a file, or numbers that make no pendulum.
    """
    content = read_toml(path, "a file of identified pendulums")
    robot, bush = content.pop("robot", None), content.pop("bush", [])
    if not isinstance(robot, str) or not isinstance(bush, list) or not all(is_number(value) for value in bush):
        raise InputError(f'{path}: needs robot = "NAME", and may say bush = [...]: see `sot run damping identify`')
    cases = {}
    for plane, supports in content.items():
        if plane not in PLANES or not isinstance(supports, dict):
            raise InputError(f"{path}: '{plane}' is no plane: there are [{', '.join(PLANES)}]")
        for support, entry in supports.items():
            if support not in SUPPORTS or not isinstance(entry, dict):
                raise InputError(f"{path}: '{plane}.{support}' is no support: there are {', '.join(SUPPORTS)}")
            cases[plane, support] = _case(f"{path}: [{plane}.{support}]", entry)
    return Identified(robot, tuple(map(float, bush)), cases)


def _case(where: str, entry: Mapping[str, object]) -> IdentifiedCase:
    if set(entry) != {*PARAMETERS, *SERIES}:
        raise InputError(f"{where} needs {', '.join((*PARAMETERS, *SERIES))}, and nothing else")
    numbers = {name: entry[name] for name in PARAMETERS}
    if not all(is_number(value) and value >= 0.0 for value in numbers.values()):  # type: ignore[operator]
        raise InputError(f"{where}: {', '.join(PARAMETERS)} are numbers that are not negative")
    pendulum = Pendulum(**{name: float(value) for name, value in numbers.items()})  # type: ignore[arg-type]
    if not (pendulum.mass > 0.0 and pendulum.length > 0.0 and pendulum.natural_frequency > 0.0):
        raise InputError(f"{where}: mass and length must be positive, and the stiffness more than m g l")
    rows = [entry[name] for name in SERIES]
    if not all(isinstance(row, list) and len(row) > 1 and all(map(is_number, row)) for row in rows):
        raise InputError(f"{where}: frequency, gain and phase are lists of numbers")
    frequency, gain, phase = (np.array(row, dtype=float) for row in rows)
    if not (len(frequency) == len(gain) == len(phase) and frequency[0] > 0.0 and np.all(np.diff(frequency) > 0.0)):
        raise InputError(f"{where}: frequency, gain and phase are of one length, the frequencies positive and rising")
    if not np.all(gain > 0.0):
        raise InputError(f"{where}: gains are positive")
    return IdentifiedCase(pendulum, FrequencyResponse(frequency, gain * np.exp(1j * np.deg2rad(phase))))


def _numbers(values: object) -> str:
    return "[" + ", ".join(f"{value:.5g}" for value in np.asarray(values, dtype=float).tolist()) + "]"
