"""The line before and after a probe, and the words of its PLC."""

__all__ = ["setup_jobs", "view"]
