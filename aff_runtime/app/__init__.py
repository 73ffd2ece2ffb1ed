"""Wiring: the one place where rooms meet."""
