"""A dance copied, made stable and edited, three robots side by side: Ramos 2011, VI, and its Figures 3 to 8."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from scenarios.inputs.clips import find_clip
from scenarios.inputs.stack_file import Composer, Composition
from scenarios.ramos2011.ramos_edits import (
    dancer_hand_height,
    hand_edits,
    knee_edits,
    low_hand_spans,
    oscillating_knees,
    slide_spans,
    spans_without_slides,
)
from scenarios.ramos2011.ramos_figures import geometric_figures, hand_figures, knee_figures, slide_figures
from scenarios.ramos2011.ramos_pictures import draw_curves, draw_scalogram, draw_thumbnails
from scenarios.ramos2011.ramos_view import ThreeDances, write_recording
from scenarios.replay import (
    RECORDING_FILE,
    REPORT_FILE,
    TIMELINE_FILE,
    Dance,
    ProgressCallback,
    Replay,
    check_writable,
    composed_stack,
    make_solver,
    run_motion,
    write_outputs,
)
from sim.reporting import report, timeline
from sim.reporting.slides import LIGHT_LOAD_RANGE, SMOOTHING_WINDOW_S
from sot.behaviours.rehearsal import rebalance, rehearse
from sot.behaviours.sliding import SlidingSchedule
from sot.control.contact import Contact
from sot.control.stack import Stack
from sot.motion import Human, plan, read, recognise
from sot.motion.edit import Edit
from sot.motion.feet.slides import SLIDE_FORWARD
from sot.motion.human.human import SIDES
from sot.motion.human.oscillation import find_oscillations
from sot.motion.plan import CAPTURE_NOISE_HZ, Plan, sampled_motion
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tasks import Balance, FootSliding, JointBounds, LeastForces, Posture, SelfCollision, TorqueBounds, TorqueRateBounds

Array = NDArray[np.float64]

CLIP = "lafan1_dance1_subject2"
MAX_DURATION = 40.0
"""Longest part of a clip that is danced: the one in which the knees swing most [s]."""
POSTURE_STIFFNESS = 25.0
"""Stiffness λ_p of the posture, Ramos (17) [1/s²]: as a filter it is slower than a dancer's knees."""
HIP_HEIGHT_ERROR = 0.01
"""Acceptable error of the hips' height in the plan [m]; a larger one would smooth the knees' swing away."""
BODY_CLEARANCE, HAND_CLEARANCE = 0.01, 0.025
"""Least distance of parts of the robot from one another [m], and the same where a hand is raised to the head."""
POSTURE_RUN, FINAL_RUN = "posture", "final"
"""Folders of the runs, each with its own recording and report."""


def run(request: Replay, out: Path, tell: ProgressCallback) -> dict[str, Any]:
    """Dance a clip as a copy, with the posture task only, and edited; lay the three beside each other.

    Args:
        request: The clip and what part of it; the rest as for a replay.
        out: Folder for recording, pictures and report, with a folder in it for each of the runs.
        tell: Told of the progress.

    Returns:
        The report.

    Raises:
        InputError: anything in the request that does not fit; nothing is written then.
    """
    make_solver(request.solver)
    check_writable(out)
    robot = Robot.load(request.robot)
    tell("reading", None)
    human = recognise(read(find_clip(request.clip)), request.mapping)
    start, duration = clip_part(human, request.start, request.duration)
    tell("planning", None)
    human = human.slice(start, duration)
    planned = plan(human, robot, "planted", request.rate, height=HIP_HEIGHT_ERROR)
    sliding = plan(human, robot, "planted", request.rate, slide=SLIDE_FORWARD, height=HIP_HEIGHT_ERROR)
    geometric = sampled_motion(robot, planned.imitation, planned.motion.phases, request.rate)
    posture = _dance_rebalanced(request, posture_stack(BODY_CLEARANCE), planned, tell)
    slides = slide_spans(sliding)
    knees = oscillating_knees(planned, slides)
    wanted = dancer_hand_height(planned)
    raised = spans_without_slides(low_hand_spans(planned, wanted, posture.run.log.trimmed()), slides)
    edits = (*knee_edits(sliding, knees), *hand_edits(sliding, raised))
    final = _dance_rebalanced(request, posture_stack(HAND_CLEARANCE, edits), sliding, tell)
    logs = posture.run.log.trimmed(), final.run.log.trimmed()
    three = ThreeDances(planned, geometric, *logs, wanted, knees, raised, slides)

    tell("recording", None)
    runs = {
        name: write_outputs(danced, out / name, tell) for name, danced in ((POSTURE_RUN, posture), (FINAL_RUN, final))
    }
    title = f"{posture.info.clip}, {start:g} to {start + duration:g} s, by {robot.label}"
    write_recording(out / RECORDING_FILE, three, title)
    draw_thumbnails(out / "thumbnails.svg", three, title)
    draw_curves(out / "curves.svg", three, title)
    draw_scalogram(out / "scalogram.svg", three, title)
    timeline.write_timeline(out / TIMELINE_FILE, final.run.log, final.info, robot)
    figures = {
        "scenario": "ramos",
        "clip": posture.info.clip,
        "robot": robot.name,
        "solver": request.solver,
        "rate_hz": request.rate,
        "start_s": start,
        "duration_s": duration,
        "fell": any(run["fell"] for run in runs.values()),
        "geometric": geometric_figures(geometric),
        "runs": {name: _run_summary(run) for name, run in runs.items()},
        "knees": knee_figures(knees, geometric, three.posture, three.final),
        "hand": hand_figures(robot, wanted, raised, three.posture, three.final),
        "slides": [slide | slide_figures(slide, planned.motion, three.posture) for slide in runs[FINAL_RUN]["slides"]],
        "edits": list(final.edits),
    }
    figures = report.rounded(figures)
    report.write_json(figures, out / REPORT_FILE)
    return figures


def show(figures: dict[str, Any], console: Console) -> None:
    """Print what the three dances came to."""
    geometric, hand = figures["geometric"], figures["hand"]
    console.print(
        f"\n{figures['clip']}, {figures['start_s']:g} to {figures['start_s'] + figures['duration_s']:g} s. "
        f"No robot on a floor does the geometric motion: its ZMP is outside the soles for "
        f"{100 * geometric['zmp_outside']:.0f} % of the time, for 5 % of it by more than "
        f"{1e3 * geometric['zmp_outside_p95_m']:.0f} mm; joints reach {geometric['velocity_max']:.1f} times their "
        f"velocity, {geometric['torque_max']:.1f} times their torque.\n",
        soft_wrap=True,
        highlight=False,
    )
    table = Table(box=None, padding=(0, 2, 0, 0))
    for words in ("", "demonstrated", POSTURE_RUN, FINAL_RUN):
        table.add_column(words, justify="right" if words else "left")
    runs = [figures["runs"][name] for name in (POSTURE_RUN, FINAL_RUN)]
    endings = (f"fell at {run['fell_at_s']:.1f} s" if run["fell"] else "upright" for run in runs)
    table.add_row("how it ended", "not simulated", *endings)
    for knee in figures["knees"]:
        when = f"{knee['start_s']:.1f} to {knee['end_s']:.1f} s, {knee['frequency_hz']:.2f} Hz"
        amplitudes = (_formatted(knee[f"{name}_deg"]) for name in ("demonstrated", POSTURE_RUN, FINAL_RUN))
        table.add_row(f"{knee['knee'].replace('_', ' ')}, {when}, deg", *amplitudes)
    off = [hand[f"{name}_rms_m"] for name in (POSTURE_RUN, FINAL_RUN)]
    table.add_row("right hand's height off the dancer's, rms, mm", "", *(_formatted(value, 1e3) for value in off))
    near = [hand[f"{name}_head_min_m"] for name in (POSTURE_RUN, FINAL_RUN)]
    table.add_row("right hand to head, least, mm", "", *(_formatted(value, 1e3) for value in near))
    console.print(table)
    for line in (*map(_slide_sentence, figures["slides"]), *figures["edits"]):
        console.print(line, soft_wrap=True, highlight=False)


def _dance_rebalanced(request: Replay, compose: Composer, planned: Plan, tell: ProgressCallback) -> Dance:
    """Dance a plan with a stack; the balance is planned anew for the rehearsed momentum."""
    tell("rehearsing", None)
    stack, schedule, _ = composed_stack(request, compose, planned.motion)
    motion = rebalance(planned.motion, rehearse(planned.motion, stack, make_solver(request.solver), schedule))
    return run_motion(request, compose, motion, planned, tell)


def clip_part(human: Human, start: float, duration: float | None) -> tuple[float, float]:
    """Which part of a clip is danced, its start and duration [s]: as asked for, or where the knees swing most.

    That is the stretch of `MAX_DURATION` with the largest sum of amplitude times duration over the oscillations of both
    knees' angles; a clip that is shorter is danced whole.
    """
    if start or duration is not None or human.duration <= MAX_DURATION:
        return start, human.duration - start if duration is None else duration
    smooth = human.low_passed(CAPTURE_NOISE_HZ)
    found = [swing for side in SIDES for swing in find_oscillations(smooth.times, knee_angle(smooth, side))]
    starts = np.arange(0.0, human.duration - MAX_DURATION, 1.0)
    swung = [
        sum(one.amplitude * max(min(one.end, t + MAX_DURATION) - max(one.start, t), 0.0) for one in found)
        for t in starts
    ]
    return float(starts[int(np.argmax(swung))]), MAX_DURATION


def knee_angle(human: Human, side: str) -> Array:
    """How far a human's knee is bent (T,) [rad]."""
    thigh, shank = (human.segment_direction(f"{side}_{segment}") for segment in ("thigh", "shank"))
    return np.arccos(np.clip(np.sum(thigh * shank, axis=1), -1.0, 1.0))


def posture_stack(clearance: float, edits: Sequence[Edit] = ()) -> Composer:
    """A stack with the paper's posture task, Ramos (17), below balance and feet that slide.

    Balance has no say in the height, nor is the trunk held upright: both are left to the posture, or little would be
    lost that edits could bring back.

    Args:
        clearance: Least distance of parts of the robot [m].
        edits: Of the motion.
    """

    def compose(robot: Robot, motion: Motion) -> Composition:
        stack = Stack(
            contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
            hard=[TorqueBounds(robot), TorqueRateBounds(robot), JointBounds(robot), SelfCollision(robot, clearance)],
            levels={
                "balance": [Balance(motion.balance, motion.feet, axes="xy")],
                "posture": [Posture(robot, motion.joints, kp=POSTURE_STIFFNESS, feedforward=False)],
                "forces": [LeastForces()],
            },
        )
        for foot in sorted({foot for phase in motion.phases for foot in phase.sliding}):
            stack.contact(foot).path = path = motion.pose(foot)
            stack.add(FootSliding(robot, foot, path), level="feet", before="posture")
        return Composition(stack, SlidingSchedule(motion.phases), tuple(edits))

    return compose


def _slide_sentence(slide: dict[str, Any]) -> str:
    """One sentence about a slide of the report."""
    return (
        f"{slide['foot'].replace('_', ' ')} slides {1e2 * slide['way_m']:.1f} cm, {slide['start_s']:.1f} to "
        f"{slide['end_s']:.1f} s: it touches the floor for {100 * slide['contact']:.0f} % of the time, with "
        f"{100 * slide['load_min']:.0f} to {100 * slide['load_max']:.0f} % of the weight (means over "
        f"{1e3 * SMOOTHING_WINDOW_S:.0f} ms; {100 * slide['light']:.0f} % of the ticks are between "
        f"{100 * LIGHT_LOAD_RANGE[0]:.0f} and {100 * LIGHT_LOAD_RANGE[1]:.0f} %, "
        f"the greatest {100 * slide['load_raw_max']:.0f} %); the ZMP "
        f"lies in the other foot for {100 * slide['zmp_inside']:.2f} % of the ticks"
    )


def _formatted(value: float | None, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.1f}"


def _run_summary(run: dict[str, Any]) -> dict[str, Any]:
    """Figures of a run that are compared; the rest is in its own report."""
    return {
        "fell": run["fell"],
        "fell_at_s": run["fell_at_s"],
        "zmp_inside": run["zmp"]["inside"],
        "joint_rms_rad": run["tracking"]["joint_rms_rad"],
        "slip_max_m": run["contacts"]["slip_max_m"],
        "self_collision_min_m": run["limits"]["self_collision_min_m"],
        "hand_path_ratio": run["likeness"]["hand_path_ratio"],
    }
