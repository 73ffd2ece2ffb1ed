"""Verdict, amended line, AFF block and page."""
