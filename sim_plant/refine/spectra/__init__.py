"""Free spectral lines in time, web travel and roll angle, which compete with the library."""

__all__ = ["aliases", "coordinates", "moment_axis", "onset_filter", "spectral_lines"]
