"""The example of a fleet: what was hidden in it, what was told, how long it took."""
