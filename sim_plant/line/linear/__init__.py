"""The closed loop in the frequency domain, independent of the kernel."""

__all__ = ["frequency"]
