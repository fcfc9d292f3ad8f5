"""Figures of a fetched bag: where all ended, how far the robot leaned, what the hand bore, and what else touched."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenarios.otani2017.bag.scene import BagPlan
from sim.log import FOOT_FIXED, RunLog
from sim.reporting.objects import object_figures
from sim.thing_paths import frame_path
from sim.world import World
from sot.robots.system import System

PALM, HOOK = "right_palm on table/top", "left_hook on bag/handle"
MEANT = ("right_palm", "left_hook")
"""Parts of the robot that may touch table and bag."""
LOOK_RATE = 200.0
"""Rate at which touches are looked at [Hz]: one of a robot's limb lasts longer."""
MAX_TILT_DEG = 20.0
"""Tilt up to which the bag counts as held upright [deg]."""


def bag_figures(
    log: RunLog, system: System, plan: BagPlan, history: Sequence[tuple[float, str]], failure: str
) -> dict[str, Any]:
    """Figures of a run.

    Args:
        log: Its rows.
        system: Robot and things as they were simulated.
        plan: What was planned.
        history: When each phase began.
        failure: Why it was given up; empty if it was not.
    """
    bag = object_figures(log, system)["bag"]
    palm, hook = (log.contact_names.index(name) for name in (PALM, HOOK))
    bears = (log.contact_mode[:, palm] == FOOT_FIXED) & (log.contact_ramp[:, palm] >= 1.0)
    measured, commanded = log.contact_normal[bears, palm], log.contact_commanded[bears, palm]
    leans = bears & (log.foot_mode[:, system.robot.feet.index("left_foot")] != FOOT_FIXED)
    off = np.abs(log.contact_normal[leans, palm] - log.contact_commanded[leans, palm])
    both = bool((log.foot_mode[-1] == FOOT_FIXED).all())
    held = bool(log.contact_mode[-1, hook] == FOOT_FIXED) and log.contact_normal[-1, hook] > 0.0
    home = both and held and bag["end_tilt_deg"] < MAX_TILT_DEG and not failure
    place, _ = frame_path(log, system, "bag", np.array([0, log.ticks - 1]))
    return {
        "mass_kg": bag["mass_kg"],
        "outcome": failure or ("home on both feet with the bag" if home else "not home"),
        "home": home,
        "beyond_sole_max_m": float((log.com[leans, 0] - plan.sole_edge).max()) if leans.any() else 0.0,
        "palm_force_max_n": float(measured.max()) if len(measured) else 0.0,
        "palm_force_commanded_max_n": float(commanded.max()) if len(commanded) else 0.0,
        "palm_force_error": float(off.mean() / log.contact_normal[leans, palm].mean()) if leans.any() else 0.0,
        "palm_force_error_p95": (
            float(np.percentile(off, 95) / log.contact_normal[leans, palm].mean()) if leans.any() else 0.0
        ),
        "bag_slip_m": bag["slip_max_m"],
        "bag_tilt_deg": bag["end_tilt_deg"],
        "bag_moved_m": (place[-1] - place[0]).tolist(),
        "phases": [{"t_s": t, "phase": name} for t, name in history],
    }


def foreign_touches(log: RunLog, system: System) -> list[str]:
    """What touched table or bag and should not have, by MuJoCo's contacts at LOOK_RATE: "part on thing"."""
    world = World(system.robot, max(log.period, 1e-3), things=system.things)
    found = set()
    for row in log.rows_at(LOOK_RATE).tolist():
        world.reset(np.concatenate([log.q[row], log.thing_q[row]]))
        for first, second in world.touches():
            if second in ("table", "bag") and first not in (*MEANT, "table", "bag"):
                found.add(f"{first} on {second}")
    return sorted(found)
