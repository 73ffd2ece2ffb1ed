"""One file an experiment, or one for a family that differs in a number."""
