"""Shared-memory ring, recorder and run files."""

__all__ = ["recorder", "ring"]
