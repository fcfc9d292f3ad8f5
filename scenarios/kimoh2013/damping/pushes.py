"""Figures of pushes, with and without the damping controller, in its forms and at several damping ratios."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from scenarios.kimoh2013.damping.identification import PAPER_RATIO
from scenarios.kimoh2013.damping.push_runs import (
    REPEATED,
    WATCHED_S,
    Planes,
    Sway,
    pushed,
    survived_impulse,
    usual_push,
)
from scenarios.kimoh2013.damping.stance import Stance, stance_of
from scenarios.kimoh2013.damping.sweep import SAMPLING_RATE
from sot.hardware.compliance import FootCompliance
from sot.robots.robot import Robot
from sot.servo.identified import PLANES, Identified
from sot.servo.pole_placement import MIN_MARGIN

RATIOS = (0.3, 0.5, PAPER_RATIO)


class Controller(NamedTuple):
    """A controller that is pushed: its name, the damping ratio asked for, and its designs; none for none."""

    name: str
    ratio: float | None
    planes: Planes | None
    margins: Mapping[str, float]


def controllers_of(identified: Identified, ratios: Sequence[float], form: str) -> list[Controller]:
    """None, one a ratio in a form, and the paper's own form at its ratio, whatever its margin.

    Raises:
        InputError: a design of that form is refused by its margin.
    """
    period = 1.0 / SAMPLING_RATE
    found = [Controller("none", None, None, {})]
    for ratio in ratios:
        found.append(Controller(f"{ratio:g}", ratio, *identified.designs(ratio, period, form, MIN_MARGIN)))
    if form != "paper":
        found.append(Controller("paper", PAPER_RATIO, *identified.designs(PAPER_RATIO, period, "paper", -np.inf)))
    return found


def push_figures(
    robot: Robot,
    compliance: FootCompliance,
    controllers: Sequence[Controller],
    frequencies: Mapping[tuple[str, str], float],
    seeds: int,
    tell: Callable[[str, float | None], object],
) -> tuple[dict[str, Any], dict[str, dict[str, Sway]]]:
    """Push a robot in each case under each controller.

    Args:
        robot: the robot.
        compliance: of its feet.
        controllers: in turn.
        frequencies: natural frequency by plane and support [Hz], of the cases to be pushed.
        seeds: pushes of each kind.
        tell: told of the progress.

    Returns:
        Figures by case and controller, and the sway of the first seed.
    """
    stances: dict[str, Stance] = {}
    figures: dict[str, Any] = {}
    sways: dict[str, dict[str, Sway]] = {}
    strongest = max((one for one in controllers if one.name != "paper"), key=lambda one: one.ratio or 0.0)
    for k, ((plane, support), frequency) in enumerate(frequencies.items()):
        name, axis = f"{plane}-{support}", PLANES.index(plane)
        stance = stances.setdefault(support, stance_of(robot, support))
        figures[name], sways[name] = {}, {}
        for one in controllers:
            tell(f"pushing {name}, {one.name}", k / len(frequencies))
            watched = WATCHED_S[one.planes is not None]
            found = [
                pushed(stance, compliance, one.planes, [usual_push(stance, axis, seed)], watched, seed)
                for seed in range(seeds)
            ]
            sways[name][one.name] = found[0]
            figures[name][one.name] = _figures(found, frequency) | {
                "asked": one.ratio,
                "margin": one.margins.get(name),
            }
            if support == "double" and one in (controllers[0], strongest):
                tell(f"pushing {name} to the limit, {one.name}", k / len(frequencies))
                signs = {"forward": 1.0, "back": -1.0} if axis == 0 else {"sideways": 1.0}
                for key, count in (("survived_n_s", 1), ("survived_repeated_n_s", REPEATED)):
                    figures[name][one.name][key] = {
                        words: survived_impulse(stance, compliance, one.planes, axis, sign, count, 1.0 / frequency)
                        for words, sign in signs.items()
                    }
    return figures, sways


def _figures(found: Sequence[Sway], frequency: float) -> dict[str, Any]:
    standing = [sway for sway in found if sway.fell_at is None]
    ratios = [sway.damping_ratio(frequency) for sway in standing]
    settling = [sway.settling_time for sway in standing]
    return {
        "fell": len(found) - len(standing),
        "runs": len(found),
        "peak_m": float(np.mean([np.abs(sway.zmp[sway.time >= 0.0]).max() for sway in standing])) if standing else None,
        "settling_s": [min(settling), max(settling)] if standing else None,
        "swing_back": float(np.mean([sway.swing_back for sway in standing])) if standing else None,
        "damping_ratio": [min(ratios), float(np.mean(ratios)), max(ratios)] if standing else None,
    }
