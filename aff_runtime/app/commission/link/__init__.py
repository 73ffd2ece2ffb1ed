"""What screen, commissioner and job say to each other, and its JSON."""

__all__ = ["answers", "client", "job_lines", "listening", "messages", "talk"]
