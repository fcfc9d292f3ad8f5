"""Kim and Oh 2013: joint limits by task corrections (IKTC), beside its rivals."""
