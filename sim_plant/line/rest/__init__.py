"""A line at rest: speeds, strains and forces of its steady state, and where a run starts."""

__all__ = ["fastest_mode", "operating_point", "resting_bodies", "start"]
