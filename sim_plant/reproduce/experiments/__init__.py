"""One file an experiment, or one for a family that differs in a number."""

__all__ = [
    "angle_error",
    "convex_roll",
    "dancers",
    "distortion",
    "eccentric_swrap",
    "ellipse_span",
    "flow_errors",
    "flow_simulations",
    "high_speed",
    "identification",
    "roll_feed_forward",
    "sampling_period",
    "span_length",
    "spectra",
    "swrap_feed_forward",
    "tension_steps",
    "warm_span",
    "wooden_insert",
    "wound_roll",
]
