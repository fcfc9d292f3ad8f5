"""What a simulated robot has between commands and joints, ankles and soles, and itself and what is known of it."""
