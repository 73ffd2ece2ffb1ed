"""A record of the ring in words, with units."""

__all__ = ["block_status", "roll_page", "status", "status_answer"]
