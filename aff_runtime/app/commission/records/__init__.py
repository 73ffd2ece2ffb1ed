"""Work on what the service recorded: refining, and a line over weeks."""

__all__ = ["maintenance_jobs", "refine_jobs"]
