"""The service in numbers for a monitoring system."""

__all__ = ["exposition", "readings"]
