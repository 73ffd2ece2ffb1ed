"""The law, pure: phases, harmonic blocks, measured response, probe."""
