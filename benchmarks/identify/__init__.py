"""The drive's own numbers from a probe, on drawn lines."""
