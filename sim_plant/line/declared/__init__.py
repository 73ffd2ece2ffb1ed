"""What a line file says, as frozen values, and the words of its laws."""

__all__ = ["declaration", "declared_bodies", "laws", "sections"]
