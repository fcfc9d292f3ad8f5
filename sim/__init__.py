"""The world that answers: MuJoCo, sensors, recording and report."""
