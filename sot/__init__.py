"""The robot, its contacts, the stack of tasks and the control tick."""
