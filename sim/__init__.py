"""The world that torques act on, MuJoCo with a robot on a floor, and the loop over it."""

from sim.convert import state_from_mujoco, state_to_mujoco
from sim.loop import Run, run
from sim.mismatch import Mismatch
from sim.own_scene import Scene
from sim.push import Push
from sim.robot_state import RobotState
from sim.scene import build_model
from sim.world import World

__all__ = [
    "Mismatch",
    "Push",
    "RobotState",
    "Run",
    "Scene",
    "World",
    "build_model",
    "run",
    "state_from_mujoco",
    "state_to_mujoco",
]
