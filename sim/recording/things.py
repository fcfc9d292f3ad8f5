"""The things of a run in its recording: where they are, what hands feel of them, and which contacts are made when."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import rerun as rr

from sim.log import RunLog
from sim.recording.bodies import send_shapes
from sim.recording.columns import COLORS, SERIES_COLORS, Columns
from sim.recording.forces import METRES_PER_NEWTON
from sim.recording.panels import FRAME_RATE, MM_PER_M, Tab
from sim.recording.plots import Curves, Plot, States
from sim.recording.shapes import Shape, thing_shapes
from sim.thing_paths import frame_path, hand_contacts
from sot.motion.objects.events import ContactSets
from sot.robots.system import System
from sot.robots.things.thing import Thing

Array = np.ndarray
FREE, SUPPORTS, HOLDS = 0, 1, 2
SET_NAMES = ("free (E2)", "supports (E1)", "holds (E3)")


@dataclass(frozen=True)
class HandledThings:
    """What a run handles.

    Attributes:
        history: When the sets E1, E2, E3 changed, and to what; the first at the start.
        clock: The demonstration's time at every tick (T,) [s].
    """

    history: Sequence[tuple[float, ContactSets]]
    clock: Array


def send_things(columns: Columns, log: RunLog, system: System, rows: Array) -> None:
    """Send the shapes of the things of a system, as it was simulated, and arrows for the forces that hands feel."""
    for thing in system.things:
        shapes = thing_shapes(thing)
        centres, rotations = _shape_poses(thing, shapes, system, log, rows)
        send_shapes(columns, f"world/things/{thing.name}", shapes, log.time[rows], centres, rotations)
    for thing in system.moving_things:
        for k in hand_contacts(log, system, thing.name):
            surface = system.surface(log.contact_names[k].partition(" on ")[0])
            assert surface.point is not None
            place, turn = frame_path(log, system, surface.point, rows)
            origins = (place + turn @ surface.placement.translation).astype(np.float32)
            vectors = (METRES_PER_NEWTON * np.nan_to_num(log.contact_force[rows, k])).astype(np.float32)
            entity = f"world/things/force/{surface.name}"
            columns.static(entity, rr.Arrows3D.from_fields(colors=[COLORS["measured"]], radii=[0.006]))
            columns.over_time(entity, log.time[rows], rr.Arrows3D.columns(vectors=vectors, origins=origins))


def things_tab(log: RunLog, system: System, handled: HandledThings) -> Tab:
    """Curves of the hands' forces and of the things, the sets over time, and the demonstration's clock."""
    rows = log.rows_at(FRAME_RATE)
    names = [name for name in log.contact_names if "/" in name]
    columns = [log.contact_names.index(name) for name in names]
    forces = Curves("normal", log.time, log.contact_normal[:, columns], names)
    links = sorted({*handled.history[0][1].supports, *handled.history[0][1].free, *handled.history[0][1].holding})
    lanes = {link: np.full(log.ticks, FREE) for link in links}
    for start, sets in handled.history:
        from_now = log.time >= start
        for link, lane in lanes.items():
            lane[from_now] = SUPPORTS if link in sets.supports else HOLDS if link in sets.holding else FREE
    shades = [COLORS["off"], COLORS["fixed"], SERIES_COLORS[3]]
    plots: list[Plot | States] = [
        States("Sets of contacts", ("things", "sets"), log.time, lanes, SET_NAMES, shades),
        Plot("Normal force of each contact of a thing [N]", ("things", "normal"), (forces,)),
    ]
    for thing in system.moving_things:
        place, _ = frame_path(log, system, thing.name, rows)
        if thing.is_free:
            values, title = MM_PER_M * place, f"{thing.name}: position [mm]"
            axes = ["x", "y", "z"]
        else:
            start = system.coordinates[thing.name].start - system.robot.nq
            values = np.degrees(log.thing_q[rows, start : start + thing.nq])
            title, axes = f"{thing.name}: angle [deg]", [f"joint {k}" for k in range(thing.nq)]
        plots.append(Plot(title, ("things", thing.name), (Curves("way", log.time[rows], values, axes),)))
    clock = Curves("clock", log.time[rows], handled.clock[rows], ("demonstration",))
    plots.append(Plot("The demonstration's clock [s]", ("things", "clock"), (clock,)))
    return Tab("Things", tuple(plots))


def _shape_poses(
    thing: Thing, shapes: Sequence[Shape], system: System, log: RunLog, rows: Array
) -> tuple[Array, Array]:
    """Centres (T, n, 3) and rotations (T, n, 3, 3) of a thing's visible shapes."""
    model, data = thing.compiled, mujoco.MjData(thing.compiled)
    geoms = [shape.geom for shape in shapes]
    centres, rotations = np.empty((len(rows), len(geoms), 3)), np.empty((len(rows), len(geoms), 3, 3))
    start = system.coordinates[thing.name].start - system.robot.nq if thing.nv else 0
    for k, row in enumerate(rows.tolist()):
        if thing.nv:
            q = log.thing_q[row, start : start + thing.nq].copy()
            if thing.is_free:
                q[3:7] = q[[6, 3, 4, 5]]  # to MuJoCo's order wxyz
            data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        centres[k], rotations[k] = data.geom_xpos[geoms], data.geom_xmat[geoms].reshape(-1, 3, 3)
    return centres, rotations
