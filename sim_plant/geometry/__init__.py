"""Support functions, common tangents, moment arms: pure functions."""
