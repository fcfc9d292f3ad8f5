"""A run as a rerun recording: the robot beside its reference and the human, and its curves over time."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from sim.log import RunInfo, RunLog
from sim.own_scene import Scene
from sim.recording.blueprint import layout
from sim.recording.columns import Columns
from sim.recording.forces import METRES_PER_NEWTON
from sim.recording.panels import FRAME_RATE, run_tabs
from sim.recording.shapes import read_scenery
from sim.recording.stream import open_stream
from sim.recording.things import HandledThings, send_things, things_tab
from sim.recording.visuals import send_visuals
from sot.motion.performance import Performance
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from sot.robots.system import System
from sot.whole_file import atomic_write


def write_recording(
    path: Path,
    log: RunLog,
    info: RunInfo,
    motion: Motion,
    plan: Performance | None,
    scene: Scene | None = None,
    system: System | None = None,
    handled: HandledThings | None = None,
) -> None:
    """Write a run to a rerun recording (`.rrd`), which appears under its name once it is complete.

    Args:
        path: file to write.
        log: rows of the run.
        info: facts about the run.
        motion: the reference.
        plan: how the reference came from a human, if it is known.
        scene: what was in the world besides robot and floor; what does not move of it is shown.
        system: robot and things as they were simulated, if there were any.
        handled: how the robot handled them, if it did.
    """
    log, robot = log.trimmed(), motion.robot
    panels = [*([things_tab(log, system, handled)] if system and handled else []), *run_tabs(log, motion, plan)]
    blueprint = layout(motion, panels, bool(log.conflicts), things=system is not None)
    with open_recording(path, f"{info.clip}, {robot.label}", _about_text(info, robot), blueprint) as columns:
        scenery = [] if scene is None else read_scenery(robot, scene)
        send_visuals(columns, log, info, motion, plan.human if plan else None, scenery)
        if system is not None:
            send_things(columns, log, system, log.rows_at(FRAME_RATE))
        for tab in panels:
            for plot in tab.plots:
                plot.send(columns)
        for t, rows in log.conflicts:
            columns.over_time("conflicts", np.array([t]), rr.TextLog.columns(text=[rows], level=["WARN"]))


@contextmanager
def open_recording(path: Path, title: str, about: str, blueprint: rrb.Blueprint) -> Iterator[Columns]:
    """Open a recording (`.rrd`) to be filled with columns; it appears under its name once it is complete.

    Args:
        path: file to write.
        title: shown by the viewer.
        about: a text beside it, Markdown.
        blueprint: where the viewer shows what.
    """
    with atomic_write(path) as place, open_stream(place, blueprint) as stream:
        stream.send_recording_name(title)
        columns = Columns(stream)
        columns.static("about", rr.TextDocument(about, media_type=rr.MediaType.MARKDOWN))
        yield columns
        columns.send()


def _about_text(info: RunInfo, robot: Robot) -> str:
    ending = "upright to the end" if info.fell_at_s is None else f"fell at {info.fell_at_s:.2f} s: {info.reason}"
    return f"""# {info.clip}

{robot.label}, solver {info.solver}, feet {info.feet}, {info.rate_hz:.0f} Hz: {ending}.

In 3D, from left to right: the human in the robot's size, the simulated robot, the reference that it follows.

- Arrows from below: the floor's force on each foot (1 m is {1 / METRES_PER_NEWTON:.0f} N). A red arrow: a push.
- Outlines: the planned support (green); each sole by its planned contact, fixed (teal), sliding (yellow) or off (grey);
  planned footholds (thin).
- Dots on the floor: the ZMP, measured (orange), predicted by the controller (blue), planned (green); the divergent
  component of motion, measured (light violet) and planned (dark violet).
- Yellow: the centre of mass; the line on the floor is its planned way.

Red lines in the curves are limits.
"""
