"""The card beside an exported motion: whose it is, under which terms, how it was made, and what its columns are."""

from sot.exchange.body_orders import breadth_first_joints, breadth_first_links
from sot.exchange.robot_motion import RobotMotion, link_names

UNKNOWN = "not known: ask whoever recorded the clip before you share this file"


def licence_card(motion: RobotMotion, format_name: str, conventions: str, isaac: bool) -> str:
    """Text (Markdown) of the card of a motion in a format.

    Args:
        motion: What was written.
        format_name: Of the format, as `sot list formats` has it.
        conventions: Its conventions, a sentence or more.
        isaac: Whether joints and links are in Isaac Lab's order.
    """
    robot, facts = motion.robot, motion.facts
    joints, links = list(robot.joints), list(link_names(robot))
    if isaac:
        joints = [joints[k] for k in breadth_first_joints(robot)]
        links = [links[k] for k in breadth_first_links(robot)]
    order = "Isaac Lab's (breadth first)" if isaac else "MuJoCo's (depth first)"
    rows = {
        "clip": motion.name,
        "source of the clip": facts.get("source", "") or UNKNOWN,
        "licence of the clip": facts.get("licence", "") or UNKNOWN,
        "robot": f"{robot.label} ({robot.path.name})",
        "made by": facts.get("command", "unknown"),
        "revision": facts.get("revision", "unknown"),
        "what it is": "what the robot did in MuJoCo, under its dynamics, contacts and limits",
        "how it ended": facts.get("ended", "unknown"),
        "frames": f"{motion.count} at {motion.rate:g} per second",
        "format": f"{format_name}: {conventions}",
        "order": order,
    }
    table = "\n".join(f"| {key} | {value} |" for key, value in rows.items())
    return (
        f"# {motion.name}\n\n| | |\n|---|---|\n{table}\n\n## Joints, in order\n\n{', '.join(joints)}\n\n"
        f"## Links, in order\n\n{', '.join(links)}\n"
    )
