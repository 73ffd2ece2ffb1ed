"""The weighted least-squares objective and its minimum."""

__all__ = ["gauss_newton", "objective", "roll_synchronisation", "start_angles"]
