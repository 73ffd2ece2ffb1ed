"""How long one step of one line takes: one by one, and side by side."""

__all__: list[str] = []
