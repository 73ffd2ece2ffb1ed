"""Free spectral lines in time, web travel and roll angle, which compete with the library."""
