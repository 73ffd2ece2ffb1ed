"""Verdict, amended line, AFF block and page."""

__all__ = ["amend", "folder", "outcome", "page", "verdict", "wording"]
