"""Steps that a person makes now: found in the stream, decided for the robot, and planned for its centre of mass."""
