"""The simulated line as a test bench for others: fixtures of pytest, and what stands behind."""

__all__ = ["plant_host"]
