"""The commissioning card: what it is gathered from, its acts, its page on a screen."""

__all__ = ["jobs", "sources", "view"]
