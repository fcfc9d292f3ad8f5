"""What a tick computes of a state: frames and their relative motion, bias forces, what is carried."""
