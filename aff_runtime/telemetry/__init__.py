"""Shared-memory ring, recorder and run files."""
