"""The site file that follows from what is known, section by section."""

__all__ = ["site_text"]
