"""Channels whose clocks differ: an output is late by another time in each record."""

from __future__ import annotations

from sim_plant.refine.without_line.general.effect import GeneralEffect, Number

EFFECT = GeneralEffect(
    name="channel_shift",
    stage="shift",
    text="the output's column is later than the inputs' by another time in each record",
    numbers=(Number(name="shift_s", text="output later than in the first record by"),),
)
