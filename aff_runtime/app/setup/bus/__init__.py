"""`setup` on a bus: its files name the signals, and each is found among them."""

__all__ = ["files", "flow", "questions"]
