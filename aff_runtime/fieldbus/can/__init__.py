"""CAN by DBC."""

__all__ = [
    "dbc",
    "frame_socket",
    "frames",
    "gateway",
    "heard_frames",
    "heard_values",
    "layout",
    "link",
    "load",
    "named_signal",
    "phase_lock",
    "reader",
    "slcan_tty",
    "writer",
]
