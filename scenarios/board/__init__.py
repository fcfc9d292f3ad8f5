"""`sot bench --suite g1-reference-tracking`: a board of learned trackers, by its own protocol."""
