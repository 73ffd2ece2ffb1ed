"""Words that every floor of the plant shares."""

__all__ = [
    "arrays",
    "c_arrays",
    "effects",
    "jit",
    "kernel_sources",
    "order_tracking",
    "plain_file",
    "ports",
    "profiles",
    "runge_kutta",
    "shipped",
    "signatures",
    "svg",
    "worker_pool",
    "yaml_edit",
]
