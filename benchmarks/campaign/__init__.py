"""The campaign: `sim-plant refine` on random records that other code made, and its score.

Nothing here knows the product's model: geometry, integrator, drives, sensors and effects are
written again (``contact``, ``motion``, ``machine``, ``effects``). The product is run through its
command line alone (``refine_runs``).
"""
