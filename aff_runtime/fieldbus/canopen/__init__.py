"""CANopen: nodes by EDS."""

__all__ = ["device_402", "eds_file", "link"]
