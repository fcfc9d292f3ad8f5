"""Only the upper body dances: its joints follow a clip, the legs and the balance stay as they stand."""
# python docs/examples/05_upper_body.py

from scenarios import find_clip
from sim import World, run
from solvers import Cascade
from sot.control import Contact, Controller, Stack
from sot.motion import Motion, plan, read, recognise
from sot.robots import Robot
from tasks import Balance, JointBounds, LeastForces, Posture, SelfCollision, TorqueBounds

robot = Robot.load("hrp2")
human = recognise(read(find_clip("groove"))).slice(0.0, 2.0)
dance = plan(human, robot, "planted", rate=500.0).motion
stand = Motion.standing(robot, dance.duration, 500.0)
upper = [joint for k, joint in enumerate(robot.joints) if k not in robot.groups["legs"]]

stack = Stack(
    contacts=[Contact(robot.surface(foot)) for foot in robot.feet],
    hard=[TorqueBounds(robot), JointBounds(robot), SelfCollision(robot)],
    levels={
        "balance": [Balance(stand.balance)],
        "upper body": [Posture(robot, dance.joints, upper)],
        "legs": [Posture(robot, stand.joints, "legs")],  # they give way to balance only
        "forces": [LeastForces()],
    },
)
done = run(Controller(robot, stack, Cascade(), 0.002), World(robot, 0.002), stand)
