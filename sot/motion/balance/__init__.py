"""Balance: the motion of the centre of mass and the waist that keeps the zero-moment point in the soles."""
