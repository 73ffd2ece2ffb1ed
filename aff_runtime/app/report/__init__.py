"""A record of the ring in words, with units."""
