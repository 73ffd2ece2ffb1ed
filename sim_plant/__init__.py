"""A model of a whole web line that speaks the same wire as the real one."""

__all__ = ["cli", "fleet", "pytest_plugin", "refine"]
