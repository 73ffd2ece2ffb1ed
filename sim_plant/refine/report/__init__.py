"""Verdict, amended line, AFF block and page."""

__all__ = [
    "aff_block",
    "amend",
    "announce",
    "findings",
    "folder",
    "outcome",
    "page",
    "plain",
    "site_edit",
    "summary",
    "verdict",
    "wording",
]
