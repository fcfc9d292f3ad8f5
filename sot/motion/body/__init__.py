"""The body: a human's pose retargeted to the robot's joints within their limits, frame by frame and over the clip."""
