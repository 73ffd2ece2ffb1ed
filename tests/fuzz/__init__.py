"""Bounded fuzzing of the codecs and of the config loader; ``make fuzz``, or a short fixed run."""
