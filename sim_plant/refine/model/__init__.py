"""The declared line under a record, and every effect and declared number that may differ."""

__all__ = [
    "hypotheses",
    "nuisances",
    "parameter_effects",
    "place",
    "record_match",
    "run_limits",
    "run_match",
    "simulation_pool",
    "twin",
]
