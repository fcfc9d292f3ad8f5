"""What a stack is made of: one file a task."""
