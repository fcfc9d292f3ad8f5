"""Edits of a dance as tasks of a stack, Ramos IV-B: each outranks, while it lasts, the posture of what it moves."""

from collections.abc import Sequence
from itertools import combinations

from sot.control.pose import AXIS_NAMES
from sot.control.schedule import Schedule
from sot.control.stack import Stack
from sot.control.task import Task
from sot.control.transition import TASK_RAMP
from sot.motion.body.limb import refit_limb
from sot.motion.edit import Edit, SampledOffset, edited_joint_reference, edited_point_reference
from sot.motion.trajectory import Motion
from sot.robots.robot import GROUPS, Robot
from tasks.operational_point import AXES, OperationalPoint
from tasks.posture import Posture

GUIDE_WEIGHT = 0.2
"""Weight of the posture that guides a limb beside the edit of its point [m]: the lever of a joint at which both count
alike."""


def edit(stack: Stack, schedule: Schedule, motion: Motion, edits: Sequence[Edit]) -> list[str]:
    """Schedule the tasks of edits of a motion; the reference is x_n(t) = x_o(t) + x_m(t).

    What is edited of one point or joint has a level of its own, before the first level that has the posture of the limb
    which it moves, or another task on the same point. That posture stays, as a guide for what the edit leaves open.

    An edit that is `limb_only` moves the limb's joints and no others: where they cannot do it, the rest of the body
    does not jump in. In its level the limb is guided by a motion of its own, feed-forward included, which is fitted to
    the edit within the limits of its joints: a stretched arm, which cannot move along itself, does not flail.

    Args:
        stack: The robot's stack, with the levels that it has when the edits come.
        schedule: The schedule to which they are added.
        motion: The motion that is edited.
        edits: Any that do not change the same thing at the same time.

    Returns:
        A line for each edit: what it changes, when, and what it outranks.

    Raises:
        InputError: An edit that does not fit the robot, the motion, or another edit.
    """
    for one in edits:
        one.check(motion.robot, motion.duration)
        if one.limb_only and len(_limb_joints(motion.robot, one)) == motion.robot.na:
            raise one.error(f"{one.of} is on no limb: leave limb_only out")
    for (k, one), (_, other) in combinations(enumerate(edits, 1), 2):
        if one.overlaps(other):
            start, end = max(one.span[0], other.span[0]), min(one.span[1], other.span[1])
            raise other.error(f"changes {_description(other)} from {start:g} to {end:g} s, as edit {k} does already")
    changes = [SampledOffset.of(one, motion) for one in edits]
    fitted: dict[str, Motion] = {}
    lines = []
    for k, one in enumerate(edits, 1):
        own = [(other, change) for other, change in zip(edits, changes, strict=True) if other.of == one.of]
        outranked = _first_outranked_level(stack, motion.robot, [other for other, _ in own])
        task, guides = _edit_task(motion, one, own, f"edit {k}"), []
        if one.limb_only:
            free = sorted(_limb_joints(motion.robot, one) - {other.of for other in edits})
            if one.of not in fitted:
                fitted[one.of] = _limb_motion(motion, free, own)
            guides = [Posture(motion.robot, fitted[one.of].joints, free, weight=GUIDE_WEIGHT, name=f"edit {k} guide")]
        start, end = one.span
        level = f"{one.of} edited"
        # The task is there before anything changes, and until nothing does any more.
        for asked in [task, *guides]:
            schedule.add(start - TASK_RAMP, asked, level, before=outranked).remove(end + TASK_RAMP, asked.name)
        over = f"outranks '{outranked}', which stays as a guide" if outranked else "has no posture to outrank"
        alone = ", by its limb alone" if one.limb_only else ""
        lines.append(f"edit {k}: {_description(one)}, {start:g} to {end:g} s{alone}: {over}")
    return lines


def _edit_task(motion: Motion, one: Edit, own: Sequence[tuple[Edit, SampledOffset]], name: str) -> Task:
    """Task of an edit; its reference includes all edits of the same point or joint."""
    if not one.rows:
        reference = edited_joint_reference(motion.robot, motion.joints, {one.of: [change for _, change in own]})
        return Posture(motion.robot, reference, [one.of], name=name)
    path = edited_point_reference(motion.pose(one.of), [(other.rows, change) for other, change in own])
    axes, limb = (
        "".join(AXES[row] for row in one.rows),
        sorted(_limb_joints(motion.robot, one)) if one.limb_only else None,
    )
    return OperationalPoint(motion.robot, one.of, path, axes, name=name, joints=limb)


def _limb_motion(motion: Motion, joints: Sequence[str], own: Sequence[tuple[Edit, SampledOffset]]) -> Motion:
    """Motion whose limb alone does what the edits of its point ask for."""
    path = edited_point_reference(motion.pose(own[0][0].of), [(other.rows, change) for other, change in own])
    wanted = [(row, *other.span) for other, _ in own if other.limb_only for row in other.rows]
    return refit_limb(motion, joints, own[0][0].of, wanted, path)


def _description(one: Edit) -> str:
    return f"{one.of} {'to a target' if one.target is not None else one.axis}" if one.rows else one.of


def _first_outranked_level(stack: Stack, robot: Robot, some: Sequence[Edit]) -> str | None:
    """The first level with a task that edits interfere with, or one that decides on the forces that are left."""
    limbs = [(one, _limb_joints(robot, one)) for one in some]
    for name, tasks in stack.levels:
        if any(_interferes_with(task, one, limb) for task in tasks for one, limb in limbs):
            return name
    return None


def _interferes_with(task: Task, one: Edit, limb: set[str]) -> bool:
    if isinstance(task, Posture):
        return not limb.isdisjoint(task.labels)
    if isinstance(task, OperationalPoint):
        return task.point == one.of and any(AXIS_NAMES[row] in task.labels for row in one.rows)
    return task.variable == "force"


def _limb_joints(robot: Robot, one: Edit) -> set[str]:
    """Names of the joints of the limb that an edit moves: those of the group that carries the point, or all of them if
    that is on the base."""
    if not one.rows:
        return {one.of}
    carrier = robot.model.names[robot.model.frames[robot.point(one.of)].parentJoint]
    for group in GROUPS:
        names = {robot.joints[k] for k in robot.groups[group]}
        if carrier in names:
            return names
    return set(robot.joints)
