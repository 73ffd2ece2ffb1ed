"""CAN by DBC."""

__all__ = [
    "dbc",
    "frame_socket",
    "frames",
    "gateway",
    "heard_frames",
    "layout",
    "link",
    "load",
    "phase_lock",
    "reader",
    "slcan_tty",
    "writer",
]
