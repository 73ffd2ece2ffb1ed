"""Shared-memory ring, recorder and run files."""

__all__ = ["header", "recorder", "recorder_messages", "ring"]
