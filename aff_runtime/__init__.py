"""Adaptive feed-forward beside the PI drives of a web line; it fails to zero."""

__version__ = "0.1.0"  # the only place; pyproject.toml reads it from here

__all__ = ["__version__", "app", "base", "cli", "config", "core", "loop", "telemetry"]
