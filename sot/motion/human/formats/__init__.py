"""Readers of the files that people bring: each makes a `Capture` of one kind of file."""
