"""The line in real time behind a PLC on a wire."""

__all__ = ["answers", "control_client", "faults", "map_file", "serve"]
