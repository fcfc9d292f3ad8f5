"""The human: from a file of joint angles to a skeleton with known names."""
