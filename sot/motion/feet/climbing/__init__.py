"""Steps onto what a scene has above the floor: where, and over which edges."""
