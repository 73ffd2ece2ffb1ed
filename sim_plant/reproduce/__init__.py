"""The source, experiment by experiment: figure, number, claim, verdict."""

__all__ = ["gallery"]
