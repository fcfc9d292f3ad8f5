"""Whether compliant feet can carry what stands on them."""

from sot.errors import InputError
from sot.gravity import GRAVITY
from sot.hardware.compliance import FootCompliance, bush_position
from sot.motion.feet.contacts import phase_indices
from sot.motion.trajectory import Motion


def refuse_soft_feet(compliance: FootCompliance, motion: Motion) -> None:
    """Check that the bushes of the feet that stand can hold the robot up, in every phase of a motion.

    It stands on them as an inverted pendulum, Kim & Oh (26): the stiffness of all standing feet together must be more
    than m g l, with l the height of the centre of mass above the bushes.

    Raises:
        InputError: it is not; the least that can stand is said.
    """
    robot = motion.robot
    weight = robot.mass * GRAVITY
    bush = bush_position(robot, robot.feet[0])[2]
    rows = phase_indices(motion.phases, motion.times)
    for index, phase in enumerate(motion.phases):
        heights = motion.com[rows == index, 2]
        if not phase.feet or not len(heights):
            continue
        floor = min(pose.translation[2] for pose in phase.feet.values())
        least = weight * float(heights.max() - floor - bush) / len(phase.feet)
        for axis in ("roll", "pitch"):
            if getattr(compliance, axis) <= least:
                feet = f"{len(phase.feet)} feet" if len(phase.feet) > 1 else f"the {next(iter(phase.feet))} alone"
                raise InputError(
                    f"--feet-compliance: {getattr(compliance, axis):g} N m/rad in {axis} cannot hold the robot up on "
                    f"{feet.replace('_', ' ')}, from {phase.start:.2f} s on: give more than m g l, {least:.0f} N m/rad "
                    "a foot"
                )
