"""The wire: register codec and transports."""

__all__ = [
    "can",
    "can_catalogue",
    "canopen",
    "modbus",
    "probe_frames",
    "scan_edge",
    "signal_names",
]
