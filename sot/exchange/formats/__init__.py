"""The formats: a file each, with the one function that writes it and the one that reads it."""
