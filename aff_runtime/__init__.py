"""Adaptive feed-forward beside the PI drives of a web line; it fails to zero."""
