"""Verdict, amended line, AFF block and page."""

__all__ = [
    "aff_block",
    "amend",
    "announce",
    "beside_rival",
    "confidence",
    "findings",
    "folder",
    "next_step",
    "outcome",
    "page",
    "partly",
    "plain",
    "site_edit",
    "summary",
    "verdict",
    "wording",
]
