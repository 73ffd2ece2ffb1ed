"""Words that every floor of the plant shares."""

__all__ = [
    "arrays",
    "effects",
    "jit",
    "order_tracking",
    "ports",
    "profiles",
    "runge_kutta",
    "signatures",
    "svg",
]
