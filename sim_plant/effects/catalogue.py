"""Every effect, one row each; a new effect is one file, one row here, one test."""

from __future__ import annotations

from sim_plant.base.effects import Effect
from sim_plant.effects import eccentric_roller, out_of_round_roll, unbalanced_roller

CATALOGUE: tuple[Effect, ...] = (
    out_of_round_roll.EFFECT,
    eccentric_roller.EFFECT,
    unbalanced_roller.EFFECT,
)
BY_NAME = {effect.name: effect for effect in CATALOGUE}
