"""The line as a co-simulation unit for other simulators and real-time targets: an FMU."""

__all__ = ["fmu"]
