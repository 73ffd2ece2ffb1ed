"""Time: absolute deadlines, real-time rights, the cycle, jitter statistics."""

__all__ = ["cycle", "messages", "ports", "realtime", "record", "watchdog"]
