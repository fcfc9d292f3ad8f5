"""How the bag is fetched, phase by phase; each begins when the robot is ready for it."""

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin

from scenarios.otani2017.bag.scene import HOOKING, PALM_DOWN, BagPlan
from sot.behaviours.manipulation.hand_support import HandSupport
from sot.behaviours.manipulation.phases import PhasedSchedule
from sot.control.contact import Contact
from sot.robots.robot import Robot

Array = np.ndarray

# In leg lengths.
STANDOFF = 0.12  # of the palm above the table
OVERTRAVEL = 0.08  # beyond the expected surface, at which an approach is given up
BESIDE_TABLE = (0.40, -0.72, 1.62)  # of the right hand's point, on its way around the table's edge
BEHIND_TABLE = (0.42, 0.50, 1.68)  # of the left hand's point, on its way
BEFORE_HANDLE = 0.36  # of the left hand's point from where it hooks
BELOW_HANDLE = 0.04  # of the hook, before it touches
FOOT_LIFTED = (-0.08, 0.0, 0.11)
FOOT_STANDOFF = 0.05
BAG_LIFTED = 0.12
# In √(leg/g).
HOLDING_TIME = 4.0  # at the end
LONGEST = 200.0


class BagSchedule(PhasedSchedule):
    """Lean on the table, lift a foot, reach beyond it, hook the bag, bring it home, and stand on both feet.

    Args:
        robot: Who does it.
        plan: Where all is to be.
        contacts: By name: "left_foot", "palm", "hook", "lying".
    """

    def __init__(self, robot: Robot, plan: BagPlan, contacts: Mapping[str, Contact]) -> None:
        led = {point: place for point, place in plan.start.items() if point != "right_foot"}
        super().__init__(robot, led, plan.middle, 0.0)
        self.extra_time = LONGEST * self.unit
        self.plan, self._contacts = plan, contacts
        self.palm, self._arm = HandSupport(contacts["palm"], self.leg), robot.joint_numbers("right_arm")

    def phases(self) -> Iterator[None]:
        """All phases."""
        yield from self._support()
        yield from self._stand_on_one_foot()
        yield from self._reach()
        yield from self._hook()
        yield from self._lift()
        yield from self._come_home()

    def retreat(self) -> Iterator[None]:
        """Let go of what is not held yet, and stand on both feet again."""
        if self.carried and self._contacts["lying"].mode == "off":
            yield from self._bring_bag_home()
        elif self._contacts["hook"].mode == "fixed":
            self.carried = ()
            yield from self.give_load(self._contacts["hook"])
            self.guides["left_hand"].start_at(self.measured("left_hand"))
        if not self.carried:
            yield from self._withdraw_left_hand()
        yield from self._come_home()

    def _support(self) -> Iterator[None]:
        """The trunk leans, and the right hand is put on the table."""
        self.phase("hand on the table")
        durations = [self.lead(point, place) for point, place in self.plan.trunk.items()]
        above = self._shifted(self.plan.palm, (0.0, 0.0, STANDOFF))
        yield from self.lead_through("right_hand", self._place(BESIDE_TABLE, PALM_DOWN), above)
        yield from self.wait(max(durations))
        down = np.array([0.0, 0.0, -1.0])
        yield from self.touch("right_hand", self.palm.contact, down, (STANDOFF + OVERTRAVEL) * self.leg)
        yield from self.support_by(self.palm, self._arm)

    def _stand_on_one_foot(self) -> Iterator[None]:
        self.phase("one foot")
        self.lead_com(self.plan.over_foot)
        yield from self.settled_com()
        yield from self.give_load(self._contacts["left_foot"])
        self.guides["left_foot"].start_at(self.measured("left_foot"))
        yield from self.lead_through("left_foot", self._shifted(self.plan.start["left_foot"], FOOT_LIFTED))

    def _reach(self) -> Iterator[None]:
        """The centre of mass goes beyond the sole, the left hand before the handle."""
        self.phase("reach")
        self.lead_com(self.plan.leaning)
        yield from self.lead_through("left_hand", self._place(BEHIND_TABLE, HOOKING), self._before_handle)
        yield from self.settled_com()

    def _hook(self) -> Iterator[None]:
        """The left hand goes below the handle and up until it touches."""
        self.phase("hook")
        yield from self.lead_through("left_hand", self._below_handle)
        hook, up = self._contacts["hook"], np.array([0.0, 0.0, 1.0])
        yield from self.touch("left_hand", hook, up, (BELOW_HANDLE + OVERTRAVEL) * self.leg)
        yield from self.take_load(hook)

    def _lift(self) -> Iterator[None]:
        """The bag's weight counts as the robot's own, and leaves the table."""
        self.phase("lift")
        self.carried = ("bag",)
        yield  # its centre of mass is taken over at the next state
        yield from self.settled_com()
        yield from self.give_load(self._contacts["lying"])
        yield from self.lead_through("left_hand", self._shifted(self.measured("left_hand"), (0.0, 0.0, BAG_LIFTED)))
        yield from self._bring_bag_home()

    def _bring_bag_home(self) -> Iterator[None]:
        self.lead_com(self.plan.over_foot)
        yield from self.lead_through("left_hand", self.plan.home)

    def _withdraw_left_hand(self) -> Iterator[None]:
        """Without a bag the left hand goes back the way that it came."""
        hand = self.measured("left_hand").translation
        if hand[0] > self._before_handle.translation[0] + BELOW_HANDLE * self.leg:
            yield from self.lead_through("left_hand", self._below_handle, self._before_handle)
        yield from self.lead_through("left_hand", self._place(BEHIND_TABLE, HOOKING), self.plan.start["left_hand"])

    def _come_home(self) -> Iterator[None]:
        """Both feet stand, then the hand leaves the table, then the trunk is upright."""
        self.phase("both feet")
        foot, palm, rest = self._contacts["left_foot"], self.palm.contact, self.plan.start
        if foot.mode == "off":
            self.lead_com(self.plan.over_foot)
            yield from self.settled_com()
            if self.palm.is_given_up:
                yield from self.trust(self.palm, 1.0, 0.0)  # the foot alone could carry now
            yield from self.lead_through("left_foot", self._shifted(rest["left_foot"], (0.0, 0.0, FOOT_STANDOFF)))
            farthest = (FOOT_STANDOFF + OVERTRAVEL) * self.leg
            yield from self.touch("left_foot", foot, np.array([0.0, 0.0, -1.0]), farthest)
            yield from self.take_load(foot)
        self.lead_com(self.plan.middle)
        yield from self.settled_com()
        self.phase("hand off")
        if palm.mode == "fixed":
            yield from self.release(self.palm, self._arm)
        self.guides["right_hand"].start_at(self.measured("right_hand"))
        above = self._shifted(self.plan.palm, (0.0, 0.0, STANDOFF))
        yield from self.lead_through("right_hand", above, self._place(BESIDE_TABLE, PALM_DOWN), rest["right_hand"])
        self.phase("home")
        yield from self.wait(max(self.lead(point, rest[point]) for point in self.plan.trunk))
        yield from self.settled_com()
        yield from self.wait(HOLDING_TIME * self.unit)

    @property
    def _below_handle(self) -> pin.SE3:
        """Of the left hand before it touches: the bag is as much lower than told as the table was found to be."""
        return self._shifted(self.plan.hook, (0.0, 0.0, self.palm.height / self.leg - BELOW_HANDLE))

    @property
    def _before_handle(self) -> pin.SE3:
        return self._shifted(self._below_handle, (-BEFORE_HANDLE, 0.0, 0.0))

    def _shifted(self, place: pin.SE3, shift: tuple[float, float, float]) -> pin.SE3:
        """A place that is shifted in world axes [leg lengths]."""
        return pin.SE3(place.rotation, place.translation + self.leg * np.array(shift))

    def _place(self, position: tuple[float, float, float], rotation: Array) -> pin.SE3:
        """A place [leg lengths]."""
        return pin.SE3(rotation, self.leg * np.array(position))
