"""Objects in a demonstration: their paths, and what touches what when."""
