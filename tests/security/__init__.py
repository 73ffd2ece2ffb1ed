"""What a file, a neighbour or a wire with bad intent gets: a sentence."""
