"""The log of a run: one row a control tick, and the facts that hold for the whole run."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, Self

import numpy as np

from sim.mismatch import NO_MISMATCH, Mismatch
from sim.push import Push
from sot.hardware.hardware import TORQUE_DRIVEN, Hardware
from sot.robots.robot import Robot
from sot.robots.system import System

FOOT_OFF, FOOT_FIXED, FOOT_SLIDING, FOOT_ROLLING = 0, 1, 2, 3
"""Values of `RunLog.foot_mode`."""


@dataclass(frozen=True, slots=True)
class Fallback:
    """A tick that another answer than the solver's own served.

    Attributes:
        t: when [s].
        level: the name of the level that needed it.
        reason: why, and what served instead, in words.
        residual: largest violation of what the answer had to preserve.
    """

    t: float
    level: str
    reason: str
    residual: float


@dataclass(slots=True)
class RunLog:
    """Columns of a run, allocated at once and filled row by row; only the first `ticks` rows are used.

    Conventions are Pinocchio's, feet in the order of `Robot.feet`, vectors in world axes, SI units. What was not
    measured at a tick is nan.

    Attributes:
        ticks: rows in use.
        level_names: the stack's tasks below the hard level, each with its level's name, in order, and those that come
            later.
        level_units: unit of each one's error.
        thing_names: the things that move, in the order of their columns.
        contact_names: the contacts that are in the stack at the start, if any is not of a foot with the floor.
        time: start of the tick [s], (T,).
        q, v: simulated configuration and velocity of the robot, (T, nq) and (T, nv).
        torque: commanded joint torque before any actuator clamps it; of servos, the torque of their motors [N m],
            (T, na).
        target: where servos are told to have the joints at the tick [rad], (T, na); no columns without servos.
        acceleration: commanded generalised acceleration of the robot, (T, nv).
        thing_q, thing_v: simulated configuration and velocity of the things, one after the other, (T, ...).
        contact_mode: planned mode of each contact of `contact_names`, as `foot_mode`, (T, C).
        contact_ramp: share of its largest normal force that each of them may take, 0..1, (T, C).
        contact_force: measured force on the first surface of each of them, world axes [N], (T, C, 3).
        contact_normal: measured sum of their normal forces [N], (T, C).
        contact_commanded: normal force that the controller's solution has at each of them [N], (T, C).
        foot_wrench: measured force and moment of the floor on each foot, the moment about the foot frame's origin
            [N, N m], (T, 2, 6).
        foot_reading: the same wrench as the force sensor above each sole has it, in the foot frame, (T, 2, 6), at the
            start of the tick's last physics step; no columns without sensors.
        sole_deflection: roll, pitch [rad] and height [m] of each sole below a compliant foot, (T, 2, 3); no columns for
            rigid ones.
        base_estimate, base_velocity_estimate: what an estimator made of the robot's base, as in q and v, (T, 7) and
            (T, 6); no columns where the controller knew the simulated state.
        foot_mode: planned contact of each foot, `FOOT_OFF`, `FOOT_FIXED`, `FOOT_SLIDING` or, while its heel rises,
            `FOOT_ROLLING`, (T, 2).
        foot_ramp: share of its largest normal force that each foot may take, 0..1, (T, 2).
        zmp_measured: from the measured contact forces [m], (T, 2); nan without load.
        zmp_control: predicted by the controller, Ramos (11) [m], (T, 2).
        zmp_planned: of the reference [m], (T, 2).
        com: centre of mass of the simulated robot [m], (T, 3).
        level_place: place in the stack of the level that each task is in, from 1 on, 0 while it is in none, (T, L).
        level_share: 1 where each task is in force, less on its way to another place, 0 while it is in none, (T, L).
        level_error: norm of each level's error, in its unit, (T, L).
        level_slack: norm of each level's violation, (T, L).
        level_active: active inequality rows of each level, (T, L).
        status: `solvers.rows.Status` of the tick, the worst of its levels', (T,).
        hard_status: that of level 0, (T,).
        residual: largest violation of what the tick's answer had to preserve, (T,).
        tick_us: time of the whole tick [µs], (T,).
        model_us, assemble_us, solve_us: its parts: robot model, rows, solver [µs], (T,).
        estimate_us: time of the estimator before the tick [µs], (T,).
        conflicts: times [s] at which level 0 had no solution, with the rows that contradicted each other; not all such
            times.
        invalid: times [s] of ticks in which a state, a task or the solver gave values that cannot be used, and which;
            the last torque was held.
        fallbacks: ticks that another answer than the solver's own served.
        self_distance: least distance between bodies of the robot [m], (T,); measured at a lower rate, nan between.
    """

    ticks: int
    level_names: tuple[str, ...]
    level_units: tuple[str, ...]
    time: np.ndarray
    q: np.ndarray
    v: np.ndarray
    torque: np.ndarray
    target: np.ndarray
    acceleration: np.ndarray
    thing_q: np.ndarray
    thing_v: np.ndarray
    contact_mode: np.ndarray
    contact_ramp: np.ndarray
    contact_force: np.ndarray
    contact_normal: np.ndarray
    contact_commanded: np.ndarray
    foot_wrench: np.ndarray
    foot_reading: np.ndarray
    sole_deflection: np.ndarray
    base_estimate: np.ndarray
    base_velocity_estimate: np.ndarray
    foot_mode: np.ndarray
    foot_ramp: np.ndarray
    zmp_measured: np.ndarray
    zmp_control: np.ndarray
    zmp_planned: np.ndarray
    com: np.ndarray
    level_place: np.ndarray
    level_share: np.ndarray
    level_error: np.ndarray
    level_slack: np.ndarray
    level_active: np.ndarray
    status: np.ndarray
    hard_status: np.ndarray
    residual: np.ndarray
    tick_us: np.ndarray
    model_us: np.ndarray
    assemble_us: np.ndarray
    solve_us: np.ndarray
    estimate_us: np.ndarray
    self_distance: np.ndarray
    conflicts: list[tuple[float, str]] = field(default_factory=list)
    invalid: list[tuple[float, str]] = field(default_factory=list)
    fallbacks: list[Fallback] = field(default_factory=list)
    thing_names: tuple[str, ...] = ()
    contact_names: tuple[str, ...] = ()

    @classmethod
    def allocate(
        cls,
        robot: Robot | System,
        ticks: int,
        level_names: Sequence[str] = (),
        level_units: Sequence[str] = (),
        contact_names: Sequence[str] = (),
        hardware: Hardware = TORQUE_DRIVEN,
        estimated: bool = False,
    ) -> Self:
        """An empty log with room for a number of ticks."""
        system = System.of(robot)
        robot, feet, levels, contacts = system.robot, len(system.robot.feet), len(level_names), len(contact_names)
        shapes: dict[str, tuple[int, ...]] = {
            "q": (robot.nq,),
            "v": (robot.nv,),
            "torque": (robot.na,),
            "target": (0 if hardware.servo is None else robot.na,),
            "acceleration": (robot.nv,),
            "thing_q": (system.nq - robot.nq,),
            "thing_v": (system.nv - robot.nv,),
            "contact_ramp": (contacts,),
            "contact_force": (contacts, 3),
            "contact_normal": (contacts,),
            "contact_commanded": (contacts,),
            "foot_wrench": (feet, 6),
            "foot_reading": (0 if hardware.sensors is None else feet, 6),
            "sole_deflection": (0 if hardware.compliance is None else feet, 3),
            "base_estimate": (7 if estimated else 0,),
            "base_velocity_estimate": (6 if estimated else 0,),
            "foot_ramp": (feet,),
            "zmp_measured": (2,),
            "zmp_control": (2,),
            "zmp_planned": (2,),
            "com": (3,),
            "level_error": (levels,),
            "level_slack": (levels,),
        }
        columns: dict[str, Any] = {
            column.name: np.full((ticks, *shapes.get(column.name, ())), np.nan)
            for column in fields(cls)
            if column.type is np.ndarray
        }
        columns["foot_mode"] = np.zeros((ticks, feet), dtype=np.int8)
        columns["contact_mode"] = np.zeros((ticks, contacts), dtype=np.int8)
        columns["level_share"] = np.zeros((ticks, levels))
        columns["level_place"] = np.zeros((ticks, levels), dtype=np.int8)
        columns["level_active"] = np.zeros((ticks, levels), dtype=np.int32)
        columns["status"], columns["hard_status"] = np.zeros((2, ticks), dtype=np.int8)
        return cls(
            ticks=0,
            level_names=tuple(level_names),
            level_units=tuple(level_units),
            thing_names=tuple(thing.name for thing in system.moving_things),
            contact_names=tuple(contact_names),
            **columns,
        )

    def lengthen(self) -> None:
        """Double the room for rows: the end of some runs is not known."""
        for column in fields(self):
            value = getattr(self, column.name)
            if isinstance(value, np.ndarray):
                empty = np.nan if value.dtype.kind == "f" else 0
                setattr(self, column.name, np.concatenate([value, np.full_like(value, empty)]))

    def trimmed(self) -> Self:
        """The rows in use, as views."""
        values = {column.name: getattr(self, column.name) for column in fields(self)}
        columns: dict[str, Any] = {
            name: value[: self.ticks] for name, value in values.items() if isinstance(value, np.ndarray)
        }
        return replace(self, **columns)

    @property
    def period(self) -> float:
        """Control period [s]."""
        return float(self.time[1] - self.time[0]) if self.ticks > 1 else 0.0

    def rows_at(self, rate: float) -> np.ndarray:
        """Rows in use that lie closest to a lower rate [Hz]."""
        if self.ticks < 2:
            return np.arange(self.ticks)
        step = max(1.0 / (rate * self.period), 1.0)
        return np.round(np.arange(0.0, self.ticks - 0.5, step)).astype(int).clip(max=self.ticks - 1)


def constant_stretches(values: np.ndarray) -> list[tuple[int, slice]]:
    """Stretches in which a column (T,) of whole numbers keeps its value: the value and its rows, in order."""
    ends = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
    return [(int(values[start]), slice(start, end)) for start, end in pairwise(ends) if start < end]


def nearest_frames(times: np.ndarray, rate: float, count: int) -> np.ndarray:
    """Indices (T,) of the closest of `count` samples from time 0 on, at a rate [Hz]."""
    return np.round(times * rate).astype(int).clip(0, count - 1)


@dataclass(frozen=True, slots=True)
class RunInfo:
    """What was run, and how it ended.

    Attributes:
        clip, robot, solver, feet: what was asked for, by name.
        rate_hz: control rate.
        speed: playing speed, 1 is the dancer's; `speed_min` the slowest at any moment, and `stretched_s` the time
            that slowing down added.
        fell_at_s: when the robot fell, None if it did not; `reason` says by which sign.
        mismatch, pushes: what the world did that the controller did not know of.
        hardware: servos, soles and sensors of the robot.
        source, licence: whose clip it is, and under which terms; empty where nobody knows.
    """

    clip: str
    robot: str
    solver: str
    feet: str
    rate_hz: float
    speed: float = 1.0
    speed_min: float = 1.0
    stretched_s: float = 0.0
    fell_at_s: float | None = None
    reason: str = ""
    mismatch: Mismatch = NO_MISMATCH
    pushes: tuple[Push, ...] = ()
    hardware: Hardware = TORQUE_DRIVEN
    source: str = ""
    licence: str = ""
