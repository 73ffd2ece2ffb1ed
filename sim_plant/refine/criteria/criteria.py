"""All criteria of refine as one frozen value."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim_plant.refine.criteria.estimation import FitCriteria, NoiseCriteria, SpectraCriteria
from sim_plant.refine.criteria.judging import JudgeCriteria
from sim_plant.refine.criteria.records import MatchCriteria, ModelCriteria, RecordCriteria
from sim_plant.refine.criteria.reporting import ReportCriteria
from sim_plant.refine.criteria.search import SearchCriteria
from sim_plant.refine.criteria.without_line import WithoutLineCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class Criteria:
    """Every threshold that decides something, by section.

    Steps, grids and passes are here where another one finds other effects or other ranges
    (``EventCriteria``, ``RangeCriteria``). Not here but in the file that uses them: those that
    change only how fast the same answer is reached, limits of size, and numbers that only serve
    to read a run of the service.
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
