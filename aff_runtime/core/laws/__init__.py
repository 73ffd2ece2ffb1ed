"""The laws that a site file can name: one row each, and those that are no room of their own."""

__all__ = ["catalogue"]
