"""Stairs or a ramp up, and down on the other side: both feet on each tread, the soles wholly on it."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin
from rich.console import Console

from scenarios.inputs.dancer import requested_human
from scenarios.inputs.stack_file import Composition
from scenarios.replay import (
    ProgressCallback,
    Replay,
    check_writable,
    make_solver,
    run_motion,
    write_outputs,
)
from scenarios.stacks import stepping_schedule, stepping_stack
from sim.hardware.sole_frames import sole_frames
from sim.log import FOOT_FIXED, RunLog
from sim.reporting import report
from sot.errors import InputError
from sot.motion import climb, plan
from sot.motion.feet.contacts import planted_phases
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.size import leg_length
from sot.robots.surface import FLOOR, Surface
from sot.robots.things.thing import Thing

Array = np.ndarray

WIDTH_LEGS = 2.0
"""Width of the stairs [leg lengths]."""
TOE_GAP_LEGS = 0.03
"""Distance of the toes from the first riser at the start [leg lengths]."""
ON_TREAD_M = 0.01
"""Distance from a tread's plane within which a sole stands on it [m]."""
NOISE_M = 0.003
"""Standard deviation of the treads' heights, with a seed [m]."""


@dataclass(frozen=True)
class Stairs:
    """What is climbed.

    Attributes:
        rise: From tread to tread, at the edge between them [m].
        depth: Of a tread [m].
        treads: Number of treads up to the highest one, which is level; one less lead down.
        slope: Of the others, up toward the highest one [rad].
        seed: Of the noise of the treads' heights, which the controller is not told; none without.
    """

    rise: float = 0.1
    depth: float = 0.3
    treads: int = 4
    slope: float = 0.0
    seed: int | None = None

    takes_clip: ClassVar[bool] = True

    def things(self, robot: Robot, noise: Array | None = None) -> list[Thing]:
        """The treads as blocks on the floor, in order; `noise` is added to their heights (n,) [m]."""
        climb = self.depth * np.tan(self.slope)
        up = [k * self.rise + (k - 0.5) * climb for k in range(1, self.treads)]
        heights = np.array([*up, self.treads * self.rise + (self.treads - 1) * climb, *reversed(up)])
        heights += 0.0 if noise is None else noise
        leg, feet = leg_length(robot), planted_phases(robot, 0.0)[0].feet
        toes = max(float(place.act(corner)[0]) for foot, place in feet.items() for corner in robot.sole(foot))
        start = toes + TOE_GAP_LEGS * leg
        found = []
        for k, height in enumerate(heights.tolist()):
            turn = pin.utils.rotate("y", self.slope * np.sign(k + 1 - self.treads))
            top = np.array([start + (k + 0.5) * self.depth, 0.0, height])
            size = self.depth / turn[0, 0], WIDTH_LEGS * leg, height + climb
            place = pin.SE3(turn, top - size[2] * turn[:, 2])
            found.append(Thing.load("block", placement=place, size=size, name=f"tread_{k + 1}"))
        return found


DEFAULT_OPTIONS = Stairs()


def run(request: Replay, stairs: Stairs, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Climb the stairs, as the human in a clip does if one is named; record and report.

    Args:
        request: Clip and its part, robot, solver, rate, pushes and mismatch.
        stairs: What is climbed.
        out: Folder to write to.
        tell: Told of the progress.

    Raises:
        InputError: Anything in the request that does not fit; nothing is written then.
    """
    check_writable(out)
    make_solver(request.solver)
    robot = Robot.load(request.robot)
    told = stairs.things(robot)
    treads = [thing.surface("top") for thing in told]
    if not request.clip and (request.start or request.duration is not None):
        raise InputError("these stairs are climbed without a clip: name the one that --start and --duration are of")
    tell("planning", None)
    planned = None
    if request.clip:
        planned = plan(requested_human(request, robot), robot, "steps", request.rate, treads=treads)
    motion = planned.motion if planned else climb(robot, [*treads, FLOOR], request.rate)
    noise = None
    if stairs.seed is not None:
        noise = NOISE_M * np.random.default_rng(stairs.seed).standard_normal(len(told))
    actual = stairs.things(robot, noise)

    def compose(robot: Robot, motion: Motion) -> Composition:
        return Composition(stepping_stack(robot, motion), stepping_schedule(robot, motion))

    asked = request if request.clip else replace(request, clip="stairs")
    danced = run_motion(asked, compose, motion, planned, tell, things=actual)
    log = danced.run.log.trimmed()
    figures = stair_figures(log, robot, [thing.surface("top") for thing in actual])
    return write_outputs(danced, out, tell, report.rounded({"stairs": figures}))


def stair_figures(log: RunLog, robot: Robot, treads: list[Surface]) -> dict[str, Any]:
    """How many treads both soles stood on, and one at least, and how near their corners came to the edges [m].

    Args:
        log: Rows of the run.
        robot: Who climbed.
        treads: As they are in physics.
    """
    positions, rotations = sole_frames(robot, log.q, log.sole_deflection)
    margins = np.full((len(robot.feet), len(treads)), np.nan)
    for index, foot in enumerate(robot.feet):
        stands = log.foot_mode[:, index] == FOOT_FIXED
        corners = positions[index][stands, None] + np.einsum("tij,nj->tni", rotations[index][stands], robot.sole(foot))
        for k, tread in enumerate(treads):
            middle = corners.mean(axis=1)
            on = np.abs(middle[:, 2] - tread.height_at(middle[:, :2])) < ON_TREAD_M
            on &= tread.edge_margins(middle) > 0.0
            if on.any():
                margins[index, k] = float(tread.edge_margins(corners[on]).min())
    reached = np.isfinite(margins)
    return {
        "treads": len(treads),
        "treads_stood_on": int(reached.all(axis=0).sum()),
        "treads_stepped_on": int(reached.any(axis=0).sum()),
        "edge_margin_min_m": float(np.nanmin(margins)) if reached.any() else None,
    }


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what became of the climb."""
    own = figures["stairs"]
    margin = "" if own["edge_margin_min_m"] is None else f", soles {1e3 * own['edge_margin_min_m']:.0f} mm from edges"
    both, one, all_treads = own["treads_stood_on"], own["treads_stepped_on"], own["treads"]
    with_both = "" if both == one else f", on {both} with both feet"
    console.print(f"stairs: stood on {one} of {all_treads} treads{with_both}{margin}", highlight=False, soft_wrap=True)
