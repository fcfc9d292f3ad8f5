"""What a scenario takes in: clips, and the small files that a user writes."""
