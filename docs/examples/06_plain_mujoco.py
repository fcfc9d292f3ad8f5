"""A dance in a MuJoCo loop of one's own, without the project's `World`."""
# python docs/examples/06_plain_mujoco.py

import mujoco

from scenarios import find_clip
from scenarios.stacks import stepping_schedule, stepping_stack
from sim import RobotState, build_model
from solvers import Cascade
from sot.control import Controller
from sot.motion import plan, read, recognise
from sot.robots import Robot

robot, period = Robot.load("hrp2"), 0.002
human = recognise(read(find_clip("groove"))).slice(0.0, 2.0)
motion = plan(human, robot, "auto", rate=1.0 / period).motion
stack, schedule = stepping_stack(robot, motion), stepping_schedule(robot, motion)
controller = Controller(robot, stack, Cascade(), period, schedule)

model = build_model(robot, period)  # robot and floor; its motors are in the order of robot.joints
data = mujoco.MjData(model)
state = RobotState(robot, model, data)  # to Pinocchio's conventions and back, in any model with the robot in it
state.write(motion.q[0], motion.v[0])
mujoco.mj_forward(model, data)
for k in range(round(motion.duration / period)):
    command = controller(k * period, *state.read())
    data.ctrl[:] = command.torque
    mujoco.mj_step(model, data)
