"""The floor under soles that stand: MuJoCo's contacts give way, too."""

import mujoco
import numpy as np

from sim.hardware.soles import sole_bodies
from sot.robots.robot import Robot
from sot.servo.sway_modes import FloorContact


def floor_contacts(model: mujoco.MjModel, data: mujoco.MjData, robot: Robot) -> dict[str, FloorContact]:
    """The floor under each sole; feet that carry nothing are left out.

    A contact's stiffness is its force over its depth. A sole turns about the point that keeps its depth.
    """
    bodies, found = sole_bodies(model, robot.feet), {}
    owners = model.geom_bodyid[data.contact.geom]
    wrench = np.empty(6)
    for foot, body in bodies.items():
        axes = data.site_xmat[model.site(foot).id].reshape(3, 3)[:, :2]
        rows = np.flatnonzero((owners == body).any(axis=1) & (data.contact.dist < 0.0)).tolist()
        stiffness, relaxation = np.zeros(len(rows)), np.zeros(len(rows))
        for i, k in enumerate(rows):
            mujoco.mj_contactForce(model, data, k, wrench)
            stiffness[i] = wrench[0] / -data.contact.dist[k]
            spring, damper, impedance, _ = data.efc_KBIP[data.contact.efc_address[k]]
            relaxation[i] = damper / (spring * impedance)
        total = float(stiffness.sum())
        if total > 0.0:
            arms = data.contact.pos[rows] @ axes
            roll, pitch = stiffness @ (arms - stiffness @ arms / total)[:, ::-1] ** 2
            found[foot] = FloorContact(np.array([roll, pitch, total]), float(stiffness @ relaxation) / total)
    return found
