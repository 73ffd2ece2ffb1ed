"""The line in real time behind a PLC on a wire."""

__all__ = ["answers", "control_client", "faults", "frame_hub", "map_file", "serve"]
