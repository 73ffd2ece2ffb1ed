"""All criteria of refine as one frozen value."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.estimation import FitCriteria, NoiseCriteria, SpectraCriteria
from sim_plant.refine.criteria.judging import JudgeCriteria
from sim_plant.refine.criteria.model import ModelCriteria
from sim_plant.refine.criteria.records import MatchCriteria, RecordCriteria
from sim_plant.refine.criteria.reporting import ReportCriteria
from sim_plant.refine.criteria.search import SearchCriteria
from sim_plant.refine.criteria.without_line import WithoutLineCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class Criteria:
    """Every number that decides what is found, or how precisely, by section.

    Thresholds, tolerances, windows, weights and counts; steps, grids and passes too. Not here but
    in the file that uses them: limits of size and time, formats, numbers of formulas, and how a
    page is laid out. ``tests/house/test_numbers_in_criteria.py`` lists those by kind.
    """

    records: RecordCriteria = field(default_factory=RecordCriteria)
    match: MatchCriteria = field(default_factory=MatchCriteria)
    model: ModelCriteria = field(default_factory=ModelCriteria)
    noise: NoiseCriteria = field(default_factory=NoiseCriteria)
    spectra: SpectraCriteria = field(default_factory=SpectraCriteria)
    fit: FitCriteria = field(default_factory=FitCriteria)
    search: SearchCriteria = field(default_factory=SearchCriteria)
    judge: JudgeCriteria = field(default_factory=JudgeCriteria)
    report: ReportCriteria = field(default_factory=ReportCriteria)
    without_line: WithoutLineCriteria = field(default_factory=WithoutLineCriteria)


CRITERIA = Criteria()
"""The criteria in force."""
