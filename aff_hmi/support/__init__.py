"""One archive for who is asked for help: what the screen shows, and nothing that is secret."""

__all__ = ["bundle", "desk"]
