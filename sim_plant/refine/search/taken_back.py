"""A selection from which effects are taken back: one, or all of them."""

from __future__ import annotations

from dataclasses import replace

from sim_plant.refine.search.selection import Selection
from sim_plant.refine.search.unexplained import line_or_broadband


def without_effects(selection: Selection) -> Selection:
    """Return the selection of the line as declared; what is unknown stays."""
    return replace(
        selection,
        fit=selection.nominal,
        spectra_left=selection.spectra_declared,
        accepted=(),
        adjustments={},
        ranges=(),
    )


def withdrawn(selection: Selection) -> Selection:
    """Return the selection without its effects: that is unknown, or what is named as that."""
    bare = without_effects(selection)
    if selection.unknown:
        return bare
    explained = selection.nominal.cost - selection.fit.cost
    spectra, heard = selection.spectra_declared, selection.heard_declared
    return replace(bare, unknown=(line_or_broadband(spectra, 0.0, explained, heard),))


def without_accepted(selection: Selection, at: int) -> Selection:
    """Return the selection without effect ``at``, nothing else fitted again."""
    kept = (*selection.accepted[:at], *selection.accepted[at + 1 :])
    ranges = (*selection.ranges[:at], *selection.ranges[at + 1 :])
    fit = selection.fit.without_effect_at(at)
    return replace(selection, fit=fit, accepted=kept, ranges=ranges)
