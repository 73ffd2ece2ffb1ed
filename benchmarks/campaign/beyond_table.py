"""What is beyond any library, as rows of the effect table."""

from __future__ import annotations

from benchmarks.campaign import beyond, effects
from benchmarks.campaign.effect_row import EffectRow

BEYOND = (
    EffectRow(
        name="dancer_swing",
        change=effects.shaken,
        outside=beyond.swing,
        coordinate=beyond.as_drawn,
        proportional=True,
    ),
    EffectRow(
        name="hidden_nip",
        change=effects.shaken,
        outside=beyond.nip,
        coordinate=beyond.as_drawn,
        proportional=True,
    ),
    EffectRow(
        name="web_wave",
        change=effects.web_wave,
        outside=beyond.wave,
        coordinate=beyond.under_tension,
        proportional=True,
    ),
    EffectRow(
        name="stiffening_web", change=effects.stiffening, outside=beyond.stiffer, standing=True
    ),
    EffectRow(
        name="gusty_drive",
        change=effects.gusty_drive,
        outside=beyond.gusts,
        standing=True,
        proportional=True,
    ),
    EffectRow(
        name="drifting_cell",
        change=effects.drifting_cell,
        outside=beyond.drift,
        standing=True,
        proportional=True,
    ),
)
