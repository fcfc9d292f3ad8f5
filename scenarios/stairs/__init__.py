"""A robot climbs stairs."""
