"""Controllers of robots whose joints have servos."""
