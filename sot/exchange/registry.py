"""The registry of formats.

To add one: a file in `formats/` with `write`, and `read` if it holds a motion; a line here; a row in docs/libraries.md;
its round trip and its hostile files in the tests.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from sot.errors import InputError
from sot.exchange.formats import (
    any4hdmi,
    contact_labels,
    gmr_pickle,
    holosoma_npz,
    lerobot,
    motion_lib,
    qpos_npz,
    soma_csv,
    tracking_npz,
    unitree_csv,
)
from sot.exchange.robot_motion import RobotMotion
from sot.exchange.simulated_motion import SimulatedMotion
from sot.robots.robot import Robot

Writer = Callable[[RobotMotion, Path], None]
Reader = Callable[[Path, Robot, float | None], RobotMotion]


@dataclass(frozen=True)
class Format:
    """A format of robot motions.

    Attributes:
        name: On the command line.
        ending: Of its files' names; empty for a folder.
        rate: Customary frames per second [Hz].
        words: Its conventions, in a sentence.
        write: Writes a motion to a file, or to a folder that it makes; None where runs write it by themselves.
        read: Reads one; None where the format holds no motion. It is given the rate that the user names, if any.
        isaac: Whether joints and links are in Isaac Lab's order.
    """

    name: str
    ending: str
    rate: float
    words: str
    write: Writer | None
    read: Reader | None
    isaac: bool = False


def _read_simulated(path: Path, robot: Robot, rate: float | None) -> RobotMotion:
    return SimulatedMotion.load(path).motion(robot, path.stem)


_NPZ = "joint_pos, joint_vel and the links' places, wxyz and velocities in the world, root not among the joints"
FORMATS = {
    one.name: one
    for one in (
        Format(
            "unitree-csv",
            ".csv",
            30.0,
            "rows of root xyz [m], quaternion xyzw, joints [rad]; no header, no rate (LAFAN1 of Unitree, mjlab)",
            unitree_csv.write,
            unitree_csv.read,
        ),
        Format(
            "soma-csv",
            ".csv",
            120.0,
            "a header; root in cm and extrinsic xyz Euler angles, joints, all in degrees; no rate (SOMA, BONES-SEED)",
            soma_csv.write,
            soma_csv.read,
        ),
        Format("tracking-npz", ".npz", 50.0, f"{_NPZ}; MuJoCo's order (mjlab)", tracking_npz.write, tracking_npz.read),
        Format(
            "tracking-npz-isaac",
            ".npz",
            50.0,
            f"{_NPZ}; Isaac Lab's order (BeyondMimic)",
            tracking_npz.write_isaac,
            tracking_npz.read_isaac,
            isaac=True,
        ),
        Format(
            "gmr-pickle",
            ".pkl",
            30.0,
            "fps, root_pos [m], root_rot xyzw, dof_pos [rad] (GMR)",
            gmr_pickle.write,
            gmr_pickle.read,
        ),
        Format(
            "motion-lib",
            ".pkl",
            30.0,
            "clip -> root_trans_offset [m], root_rot xyzw, dof [rad], pose_aa, contact_mask (PHC, ASAP, PBHC, SONIC)",
            motion_lib.write,
            motion_lib.read,
        ),
        Format(
            "holosoma-npz",
            ".npz",
            50.0,
            "joint_pos with root xyz and wxyz before the joints, bodies after one called world, names (holosoma)",
            holosoma_npz.write,
            holosoma_npz.read,
        ),
        Format(
            "any4hdmi",
            "",
            50.0,
            "a folder: manifest.json, and motions/*.npz with qpos (root xyz, wxyz, joints)",
            any4hdmi.write,
            any4hdmi.read,
        ),
        Format(
            "qpos-npz",
            ".npz",
            30.0,
            "fps and qpos (root xyz, wxyz, joints; an object after them is left out) (OmniRetarget, Humanoid-GPT)",
            qpos_npz.write,
            qpos_npz.read,
        ),
        Format(
            "contact-labels",
            "_contacts.npz",
            30.0,
            "foot_contacts (T, 2), left and right, 1 on the floor (ProtoMotions)",
            contact_labels.write,
            None,
        ),
        Format(
            "lerobot",
            "",
            50.0,
            "a folder, version 3.0: state is root xyz, xyzw and joints, action the torques, in named columns",
            lerobot.write,
            lerobot.read,
        ),
        Format(
            "sot-npz",
            ".npz",
            1000.0,
            "what every run leaves as simulated.npz, at its own rate: q, v, a, torques, contacts, wrenches, margins",
            None,
            _read_simulated,
        ),
    )
}


def find_format(name: str) -> Format:
    """A format by its name.

    Raises:
        InputError: no such format.
    """
    if name not in FORMATS:
        raise InputError(f"unknown format '{name}': choose one of {', '.join(FORMATS)}")
    return FORMATS[name]


def readable_format(name: str) -> Format:
    """A format that motions can be read from, by its name.

    Raises:
        InputError: no such format, or it holds no motion.
    """
    found = find_format(name)
    if found.read is None:
        readable = ", ".join(key for key, one in FORMATS.items() if one.read is not None)
        raise InputError(f"{name} holds no motion: choose one of {readable}")
    return found


def read_motion(path: Path, name: str, robot: Robot, rate: float | None = None) -> RobotMotion:
    """A robot's motion from a file of a format, or from a folder.

    Args:
        path: The file.
        name: Of the format.
        robot: Whose motion it is.
        rate: Frames per second [Hz], for formats that hold none.

    Raises:
        InputError: no such format or file, or it cannot be read as that.
    """
    found = readable_format(name)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    assert found.read is not None
    motion = found.read(path, robot, rate)
    if rate is not None and abs(motion.rate - rate) > 1e-6 * rate:
        raise InputError(f"{path}: says {motion.rate:g} frames per second itself, and --fps says {rate:g}")
    return motion
