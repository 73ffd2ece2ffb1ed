"""A release from a clean tree: archives, locks, bill of materials, sums, signature."""

__all__: list[str] = []
