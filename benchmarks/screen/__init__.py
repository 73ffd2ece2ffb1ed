"""What the screen costs the line, and how quick it is: targets P1 to P12 of its design."""
