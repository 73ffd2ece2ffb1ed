"""How far a number may lie from where it was found."""

from __future__ import annotations

from scipy.special import ndtri

from sim_plant.refine.criteria.criteria import CRITERIA

SPREAD = float(ndtri(0.5 + 0.5 * CRITERIA.report.confidence))
"""Standard deviations on either side of a number between which it lies."""
