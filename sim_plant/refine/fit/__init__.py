"""The weighted least-squares objective and its minimum."""

__all__ = [
    "gauss_newton",
    "objective",
    "projection",
    "robust_covariance",
    "roll_synchronisation",
    "spread",
    "start_angles",
    "start_states",
    "turning",
    "whitening",
]
