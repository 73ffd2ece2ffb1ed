"""The line in real time behind a PLC on a wire."""

__all__ = ["control_client", "faults", "map_file", "serve"]
