"""The law, pure: phases, harmonic blocks, measured response, probe."""

__all__ = [
    "bandwidth",
    "blocks",
    "compiled",
    "controller",
    "identified",
    "impulse",
    "laws",
    "monitor",
    "order_status",
    "params",
    "phase",
    "probe",
    "response",
    "ripple_watch",
    "shape",
]
