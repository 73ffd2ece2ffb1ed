"""The hand: what a person at a screen may do, how it is asked, and what is kept of it."""

__all__ = ["accounts", "audit", "audit_writer", "bucket", "client", "may", "messages"]
