"""A model of a whole web line that speaks the same wire as the real one."""

__all__ = ["cli", "codegen", "fleet", "pytest_plugin", "refine"]
