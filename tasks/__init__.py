"""What a stack is made of: one file a task."""

from tasks.balance import Balance
from tasks.bounds import AccelerationBounds, JointBounds, TorqueBounds, TorqueRateBounds
from tasks.center_of_mass import CenterOfMass
from tasks.contact_forces import LeastForces
from tasks.foot_sliding import FootSliding
from tasks.free_point import FreePoint
from tasks.momentum import AngularMomentum
from tasks.operational_point import OperationalPoint
from tasks.posture import Posture
from tasks.self_collision import SelfCollision
from tasks.swing_foot import SwingFoot

__all__ = [
    "AccelerationBounds",
    "AngularMomentum",
    "Balance",
    "CenterOfMass",
    "FootSliding",
    "FreePoint",
    "JointBounds",
    "LeastForces",
    "OperationalPoint",
    "Posture",
    "SelfCollision",
    "SwingFoot",
    "TorqueBounds",
    "TorqueRateBounds",
]
