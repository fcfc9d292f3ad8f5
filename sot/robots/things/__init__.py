"""Things: bodies that are no robot, which robots stand on, lean on, push and carry; one MJCF and one text file each."""

from sot.robots.things.thing import Thing, thing_names

__all__ = ["Thing", "thing_names"]
