"""The supervisor's side of the hand: who comes, what is done for him, what is put on record."""

__all__ = ["desk", "opening", "quotas"]
