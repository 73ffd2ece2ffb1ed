"""Stand-ins for a clock, a wire and a bus, which tests turn by hand."""
