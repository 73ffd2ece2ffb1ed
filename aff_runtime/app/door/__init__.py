"""The door for who looks on: what comes through it, and the visitor's end."""

__all__ = ["client", "messages"]
