"""What is made of frames before they are followed: their order, what is believed of them, and less noise."""
