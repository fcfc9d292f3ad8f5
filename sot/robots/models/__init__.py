"""Robot files: a model and a small text file each, and the tables that the HRP-2-like ones are written from."""
