"""Rows in, x out: solvers of prioritised problems that know numbers and no robot."""
