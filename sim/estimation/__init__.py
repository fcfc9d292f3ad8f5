"""The state that a controller is told of: the simulated one, or what an estimator makes of readings."""
