"""The declared line under a record, and every effect and declared number that may differ."""

__all__ = [
    "demand",
    "effect_at",
    "hypotheses",
    "nuisances",
    "parameter_effects",
    "record_match",
    "run_caveats",
    "run_match",
    "simulation_pool",
    "site_match",
    "start_state",
    "turned",
    "twin",
]
