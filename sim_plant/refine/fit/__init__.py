"""The weighted least-squares objective and its minimum."""

__all__ = [
    "block_covariance",
    "gauss_newton",
    "linearisation",
    "objective",
    "projection",
    "roll_synchronisation",
    "spread",
    "start_angles",
]
