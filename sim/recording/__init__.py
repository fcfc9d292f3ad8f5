"""A run as a recording for the rerun viewer."""
