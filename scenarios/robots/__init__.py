"""Robot files for people: guessed from a model, drawn, and checked."""
