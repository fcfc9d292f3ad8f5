"""Every figure of the report on runs whose answer is known."""

import json
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from rich.console import Console

from sim.log import FOOT_OFF, FOOT_SLIDING, Fallback, RunInfo, RunLog
from sim.push import Push
from sim.reference import Reference, hot_reference_us
from sim.reporting import figures
from sim.reporting.report import print_table, run_report, table_rows, write_json
from solvers.rows import Status
from sot.motion.feet.flight import Flight, flight_remark
from sot.motion.trajectory import Motion
from sot.robots.robot import Robot
from tests.sim.runs import PERIOD, perfect_log, same_plan, still_motion

INFO = RunInfo(clip="made-up", robot="hrp2", solver="cascade", feet="planted", rate_hz=1.0 / PERIOD)


@pytest.fixture(scope="module")
def motion() -> Motion:
    return still_motion(Robot.load("hrp2"), 2.0)


@pytest.fixture
def log(motion: Motion) -> RunLog:
    return perfect_log(motion).trimmed()


def test_a_perfect_run_has_no_error(motion, log):
    made = run_report(log, INFO, 0.5, motion, same_plan(motion))
    assert made["duration_s"] == pytest.approx(2.0)
    assert made["real_time_factor"] == pytest.approx(4.0)
    assert (made["fell"], made["fell_at_s"]) == (False, None)
    assert all(value == pytest.approx(0.0, abs=1e-9) for value in made["tracking"].values())
    assert made["likeness"]["segment_deg"] == pytest.approx(0.0, abs=1e-5)
    assert made["zmp"]["inside"] == 1.0
    assert made["contacts"] == {
        **{"switches": 0, "torque_step_max_nm": None, "slip_max_m": 0.0},
        "sole_tilt_max_deg": pytest.approx(0.0, abs=1e-9),
    }
    assert made["slides"] == [] and set(made["slide"].values()) == {None}
    assert made["limits"]["self_collision_min_m"] is None
    counts = {"infeasible_ticks": 0, "fallback_ticks": 0, "invalid_ticks": 0, "max_residual": 0.0}
    assert made["solver"] == {"name": "cascade", **counts, "conflicts": [], "fallbacks": [], "invalid": []}


def test_has_the_agreed_keys(motion, log):
    made = run_report(log, INFO, 0.5, motion, same_plan(motion))
    assert set(made) >= {
        *("clip", "robot", "solver", "feet", "rate_hz", "speed", "speed_min", "stretched_s", "duration_s", "fell"),
        *(
            "fell_at_s",
            "real_time_factor",
            "tick_us",
            "tracking",
            "likeness",
            "retarget",
            "steps",
            "flights",
            "zmp",
            "contacts",
        ),
        *("limits", "slide", "slides", "solver", "torque_rms_nm", "torque_saturated", "power_w", "reference_us"),
        *("command", "seed", "revision"),
    }
    assert set(made["tick_us"]) == {"p50", "p99", "max", "model", "assemble", "solve"}
    assert set(made["tracking"]) == {"mpjpe_mm", "joint_rms_rad", "com_rms_m", "hand_rms_m", "head_rms_rad"}
    assert set(made["likeness"]) == {
        *("segment_deg", "upper_segment_deg", "leg_segment_deg", "knee_bend_deg", "foot_lift_ratio", "heading_deg"),
        "hand_path_ratio",
    }
    assert set(made["retarget"]) == {"key_point_rms_m", "frames_per_s"}
    assert set(made["zmp"]) == {"inside", "min_margin_m", "rms_to_planned_m"}
    assert set(made["contacts"]) == {
        *("switches", "torque_step_max_nm", "slip_max_m", "sole_tilt_max_deg"),
    }
    assert set(made["limits"]) == {
        *("position_max_excess_rad", "velocity_max_excess", "torque_max_excess", "self_collision_min_m"),
        "saturated_joints",
    }


def test_says_what_became_of_leaps(motion, log):
    plan = same_plan(motion)
    assert run_report(log, INFO, 0.5, motion, plan)["flights"]["count"] == 0
    made = run_report(log, INFO, 0.5, motion, replace(plan, flights=(Flight(1.0, 1.5), Flight(2.0, 2.25))))
    assert made["flights"] == {"count": 2, "longest_s": 0.5}
    (said,) = made["remarks"]
    assert "leaps 2 times" in said and "up to 0.50 s" in said and "its feet stay on the floor" in said
    assert "leaps once" in flight_remark([Flight(1.0, 1.5)], stepping=True) and "it steps" in flight_remark(
        [Flight(0, 1)], True
    )
    assert run_report(log, INFO, 0.5, motion, None)["remarks"] == []


def test_tick_times(log):
    times = figures.tick_us(log)
    assert times["p50"] == pytest.approx(150.0)
    assert times["p99"] == pytest.approx(199.0)
    assert times["max"] == pytest.approx(200.0)
    assert (times["model"], times["assemble"], times["solve"]) == (20.0, 30.0, 90.0)


def test_tracking_of_a_shifted_robot_sees_the_world_but_not_the_pose(motion, log):
    log.q[:, 0] += 0.03
    log.com[:, 0] += 0.03
    off = figures.tracking(log, motion)
    assert off["mpjpe_mm"] == pytest.approx(0.0, abs=1e-9)
    assert off["com_rms_m"] == pytest.approx(0.03)
    assert off["hand_rms_m"] == pytest.approx(0.03)
    assert off["joint_rms_rad"] == 0.0


def test_tracking_of_a_turned_head(motion, log):
    yaw = motion.robot.groups["head"][0]
    log.q[:, 7 + yaw] += 0.2
    off = figures.tracking(log, motion)
    assert off["head_rms_rad"] == pytest.approx(0.2)
    assert off["joint_rms_rad"] == pytest.approx(0.2 / np.sqrt(motion.robot.na))
    assert off["hand_rms_m"] == pytest.approx(0.0, abs=1e-9)


def test_mpjpe_is_the_mean_over_key_bodies(motion, log):
    wrist = next(k for k, name in enumerate(motion.robot.joints) if name == "RARM3")
    log.q[:, 7 + wrist] -= 0.3
    robot = motion.robot
    bent, straight = (figures.Points.of(robot, q[:1]).positions for q in (log.q, motion.q))
    moved = [np.linalg.norm(bent[name][0] - straight[name][0]) for name in figures.KEY_POINTS]
    assert len(moved) == 13
    assert moved[figures.KEY_POINTS.index("right_hand")] > 0.05
    assert figures.tracking(log, motion)["mpjpe_mm"] == pytest.approx(1e3 * np.sum(moved) / 13)


def test_likeness_of_a_bent_arm(motion, log):
    elbow = motion.robot.joints.index("LARM3")
    log.q[:, 7 + elbow] -= 0.5
    alike = figures.likeness(log, same_plan(motion))
    assert alike["segment_deg"] == pytest.approx(np.rad2deg(0.5) / 10, rel=1e-6)
    assert alike["upper_segment_deg"] == pytest.approx(np.rad2deg(0.5) / 6, rel=1e-6)
    assert alike["leg_segment_deg"] == pytest.approx(0.0, abs=1e-5)


def test_likeness_of_a_bent_knee_and_of_a_turned_robot(motion, log):
    log.q[:, 7 + motion.robot.joints.index("LLEG3")] += 0.5
    alike = figures.likeness(log, same_plan(motion))
    assert alike["knee_bend_deg"] == pytest.approx(np.rad2deg(0.25), rel=1e-2)
    assert alike["leg_segment_deg"] == pytest.approx(np.rad2deg(0.125), rel=1e-2)
    assert (alike["heading_deg"], alike["foot_lift_ratio"]) == (pytest.approx(0.0, abs=1e-6), None)
    swaying = 0.2 * (np.arange(len(motion.times)) < 0.5 * len(motion.times))
    turned = replace(same_plan(motion), heading=swaying)
    assert figures.likeness(log, turned)["heading_deg"] == pytest.approx(np.rad2deg(0.1), rel=1e-2)


def test_zmp_close_to_the_edge_is_not_inside(motion, log):
    heel = min(corner[0] for corner in motion.robot.sole("left_foot"))
    place = figures.Points.of(motion.robot, motion.q[:1]).positions["left_foot"][0]
    log.zmp_measured[:100, 0] = place[0] + heel + 0.004
    log.zmp_measured[100:150] = np.nan
    found = figures.zmp(log, motion)
    assert found["inside"] == pytest.approx(1.0 - 150 / log.ticks)
    assert found["min_margin_m"] == pytest.approx(0.004)


def test_a_foot_that_slides_or_is_being_loaded_supports_nothing(motion, log):
    right = figures.Points.of(motion.robot, motion.q[:1]).positions["right_foot"][0]
    log.zmp_measured[:] = right[:2]
    assert figures.zmp(log, motion)["inside"] == 1.0
    log.foot_mode[:100, 1] = FOOT_SLIDING
    log.foot_ramp[100:200, 1] = 0.5
    assert figures.zmp(log, motion)["inside"] == pytest.approx(1.0 - 200 / log.ticks)
    log.foot_mode[:] = FOOT_OFF
    nowhere = figures.zmp(log, motion)
    assert (nowhere["inside"], nowhere["min_margin_m"]) == (0.0, None)


def test_slip_counts_from_where_a_stance_begins(motion, log):
    log.q[200:, 1] += 0.02
    assert figures.contacts(log, motion)["slip_max_m"] == pytest.approx(0.02)
    log.foot_mode[150:250] = FOOT_OFF
    made = figures.contacts(log, motion)
    assert made["slip_max_m"] == pytest.approx(0.0, abs=1e-9)
    assert made["switches"] == 4


def test_torque_steps_count_around_switches(motion, log):
    log.torque[60, 4] = 70.0  # far from any switch
    log.foot_mode[150:250, 0] = FOOT_OFF
    log.torque[155:, 3] += 20.0
    log.torque[240:, 5] -= 30.0
    assert figures.contacts(log, motion)["torque_step_max_nm"] == pytest.approx(30.0)


def test_tilt_counts_from_what_a_foot_stands_on(motion, log):
    (phase,) = motion.phases
    tilted = {foot: pin.SE3(pin.utils.rotate("y", 0.1), pose.translation) for foot, pose in phase.feet.items()}
    on_slope = replace(motion, phases=(replace(phase, feet=tilted),))
    assert figures.contacts(log, on_slope)["sole_tilt_max_deg"] == pytest.approx(np.rad2deg(0.1))
    in_the_air = replace(motion, phases=(replace(phase, end=0.5), replace(phase, start=0.5, end=1.0, feet={})))
    assert figures.contacts(log, in_the_air)["sole_tilt_max_deg"] == pytest.approx(0.0, abs=1e-6)
    both = replace(in_the_air, phases=(*in_the_air.phases, replace(phase, start=1.0, feet=tilted)))
    log.foot_mode[log.time >= 1.0] = FOOT_OFF
    assert figures.contacts(log, both)["sole_tilt_max_deg"] == pytest.approx(0.0, abs=1e-6)


def test_tilt_counts_only_while_the_foot_should_lie_flat(motion, log):
    ankle = motion.robot.joints.index("LLEG5")
    log.q[50:60, 7 + ankle] += np.deg2rad(2.0)
    assert figures.contacts(log, motion)["sole_tilt_max_deg"] == pytest.approx(2.0)
    log.foot_mode[40:70, 0] = FOOT_OFF
    assert figures.contacts(log, motion)["sole_tilt_max_deg"] == pytest.approx(0.0, abs=1e-6)


def test_excesses(motion, log):
    robot = motion.robot
    log.q[3, 7 + 4] = robot.upper[4] + 0.01
    log.v[5, 6 + 2] = -1.25 * robot.velocity[2]
    log.torque[7, 1] = 1.1 * robot.effort[1]
    log.self_distance[::10] = 0.05
    log.self_distance[50] = 0.02
    beyond = figures.limits(log, robot)
    assert beyond["position_max_excess_rad"] == pytest.approx(0.01)
    assert beyond["velocity_max_excess"] == pytest.approx(0.25)
    assert beyond["torque_max_excess"] == pytest.approx(0.1)
    assert beyond["self_collision_min_m"] == 0.02


def test_effort(motion, log):
    log.torque[:, 0], log.v[:, 6] = 30.0, -2.0
    log.torque[:40, 3] = -0.995 * motion.robot.effort[3]
    spent = figures.effort(log, motion.robot)
    assert spent["power_w"] == pytest.approx(60.0)
    assert spent["torque_saturated"] == pytest.approx(40 / log.ticks)
    assert spent["torque_rms_nm"] == pytest.approx(np.sqrt(np.mean(log.torque**2)))


def test_saturated_joints_are_named(motion, log):
    robot = motion.robot
    log.torque[:40, 3] = -robot.effort[3]
    log.torque[20:80, 7] = 0.9995 * robot.effort[7]
    log.torque[:, 2] = 0.98 * robot.effort[2]
    joints = figures.saturated_joints(log, robot)
    assert figures.effort(log, robot)["torque_saturated"] == pytest.approx(80 / log.ticks)
    assert list(joints.items()) == [
        (robot.joints[7], pytest.approx(60 / log.ticks)),
        (robot.joints[3], pytest.approx(40 / log.ticks)),
    ]
    (said,) = figures.saturation_remark(joints)
    assert robot.joints[7] in said and robot.joints[3] in said and robot.joints[2] not in said
    assert figures.saturation_remark({}) == []


def test_pushes_survived_and_not():
    pushes = (Push(1.0, (80.0, 0.0, 0.0)), Push(6.0, (0.0, 150.0, 0.0)), Push(20.0, (0.0, 300.0, 0.0)))
    info = replace(INFO, pushes=pushes)
    assert figures.pushes(info, 30.0) == {"given": 3, "survived": 3, "survived_max_ns": pytest.approx(30.0)}
    fell = replace(info, fell_at_s=7.5)
    assert figures.pushes(fell, 7.5) == {"given": 2, "survived": 1, "survived_max_ns": pytest.approx(8.0)}
    assert figures.pushes(INFO, 30.0) == {"given": 0, "survived": 0, "survived_max_ns": None}


def test_solver_counts(log):
    log.status[:10] = Status.SECOND_SOLVER
    log.status[10:13] = log.hard_status[10:13] = Status.RELAXED
    log.status[13] = log.hard_status[13] = Status.FAILED
    log.status[14] = Status.FAILED  # a lower level only: that of the levels above serves
    log.status[15] = log.hard_status[15] = Status.INVALID
    log.invalid = [(0.075, "task 'a': nan")]
    log.residual[20] = 1e-4
    counts = {"infeasible_ticks": 4, "fallback_ticks": 12, "invalid_ticks": 1}
    assert figures.solver(log) == {**counts, "max_residual": pytest.approx(1e-4)}


def test_values_that_cannot_be_used_are_told_by_whom_and_when(motion, log):
    log.invalid = [(0.5, "task 'a': nan"), (0.6, "the state: nan"), (0.7, "task 'a': nan")]
    made = run_report(log, INFO, 0.5, motion, same_plan(motion))
    first, second = made["solver"]["invalid"]
    assert first == {"what": "task 'a': nan", "ticks": 2, "first_s": 0.5, "last_s": 0.7}
    assert second["ticks"] == made["solver"]["invalid_ticks"] - 2 == 1
    assert "The last torque was held in 2 ticks from 0.500 to 0.700 s: task 'a': nan." in made["remarks"]
    assert "The last torque was held in 1 tick at 0.600 s: the state: nan." in made["remarks"]


def test_fallbacks_are_explained_in_a_few_lines(motion, log):
    log.fallbacks = [Fallback(t, "forces", "ProxQP gave up", 1e-9 * t) for t in (0.5, 0.7, 1.9)]
    log.fallbacks += [Fallback(1.0 + 0.1 * k, f"level {k}", "refused", 0.0) for k in range(4)]
    log.conflicts = [(0.25, "JointBounds: knee lower +3 rad/s² against Contact left_foot (6 rows)")]
    made = run_report(log, INFO, 0.5, motion, same_plan(motion))
    first = made["solver"]["fallbacks"][0]
    assert first == {
        **{"level": "forces", "reason": "ProxQP gave up", "ticks": 3},
        **{"first_s": 0.5, "last_s": 1.9, "max_residual": 1.9e-9},
    }
    assert sum(entry["ticks"] for entry in made["solver"]["fallbacks"]) == len(log.fallbacks)
    console = Console(file=StringIO(), width=100)
    print_table([made], console)
    told = console.file.getvalue().splitlines()[-5:]
    assert told == [
        "made-up: no solution of the hard level at 0.250 s: JointBounds: knee lower +3 rad/s² "
        "against Contact left_foot (6 rows)",
        "made-up: fallback, 3 ticks from 0.500 to 1.900 s, level forces: ProxQP gave up",
        "made-up: fallback, 1 tick at 1.000 s, level level 0: refused",
        "made-up: fallback, 1 tick at 1.100 s, level level 1: refused",
        "made-up: 2 more of these are in the report",
    ]


def test_writes_whole_json_and_a_table(motion, log, tmp_path: Path):
    log.zmp_measured[:] = np.nan
    fallen = RunInfo("made-up", "hrp2", "cascade", "planted", 200.0, fell_at_s=1.5, reason="the waist sank")
    made = run_report(log, fallen, 0.5, motion, None)
    write_json(made, tmp_path / "report.json")
    assert [path.name for path in tmp_path.iterdir()] == ["report.json"]
    read = json.loads((tmp_path / "report.json").read_text())
    assert read == made
    assert read["zmp"] == {"inside": 0.0, "min_margin_m": None, "rms_to_planned_m": None}
    assert read["likeness"]["segment_deg"] is None
    console = Console(file=StringIO(), width=100)
    print_table([made, made], console)
    shown = " ".join(console.file.getvalue().split())
    assert "fell at 1.50 s: the waist sank" in shown
    assert "slide" not in shown and "pushes" not in shown


def test_what_one_of_two_runs_has_is_told_of_both(motion, log):
    pushed = replace(INFO, pushes=(Push(1.0, (80.0, 0.0, 0.0)),))
    calm, other = (run_report(log, info, 0.5, motion, same_plan(motion)) for info in (INFO, pushed))
    told = {words: values for words, values, _, _ in table_rows([calm, other])}
    assert told["pushes survived"] == ["0", "1"]
    assert told["strongest push survived"] == ["-", "8"]


def test_reference_computation_takes_time():
    assert 1.0 < hot_reference_us() < 1e5
    reference = Reference()
    assert reference.median_us is None
    for _ in range(3):
        reference()
    assert reference.median_us == sorted(reference.times_us)[1]
