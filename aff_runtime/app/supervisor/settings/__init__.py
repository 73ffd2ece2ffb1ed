"""Other settings for a while: history, return, and the requests about them."""

__all__ = ["desk", "history"]
