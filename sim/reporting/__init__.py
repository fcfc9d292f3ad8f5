"""A run's figures, as JSON, as a table and as a page of plots."""
