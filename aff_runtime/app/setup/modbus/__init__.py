"""`setup` on Modbus: each quantity is found among registers by what its display shows."""

__all__ = ["steps"]
