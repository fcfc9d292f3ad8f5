"""Motion that arrives live: a source of stamped frames, and a reference that follows it without knowing the future."""
