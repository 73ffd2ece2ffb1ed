"""Time: absolute deadlines, real-time rights, the cycle, jitter statistics."""
