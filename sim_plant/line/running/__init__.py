"""A running line: settled, stepped, recorded, with rolls exchanged under way."""

__all__ = ["channels", "references", "simulation"]
