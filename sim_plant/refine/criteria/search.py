"""Criteria of the search: which effects are tried, fitted, accepted, and what is left over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from sim_plant.refine.criteria.criterion import DEVELOPMENT, NOT_RECORDED, criterion
from sim_plant.refine.criteria.degeneracy import DegeneracyCriteria
from sim_plant.refine.criteria.events import EventCriteria
from sim_plant.refine.criteria.profiles import ProfileCriteria
from sim_plant.refine.criteria.recurring import RecurringCriteria
from sim_plant.refine.criteria.sticking import StickingCriteria


@dataclass(frozen=True, slots=True, kw_only=True)
class ScreeningCriteria:
    """Which hypotheses are simulated, and which of those are fitted."""

    periodic_chi2_reduction: float = criterion(
        80.0,
        "chi2 above its degrees of freedom",
        "a periodic effect is simulated where a free spectral line at its coordinate has more",
        DEVELOPMENT,
    )
    profile_chi2_share: float = criterion(
        0.5,
        "of periodic_chi2_reduction",
        "the same for a profile",
        "its power is spread over many orders: each of them is small",
    )
    profile_pairs: int = criterion(
        2,
        "pairs of numbers",
        "an effect of more is a profile: only the orders that pay are kept",
        "definition",
    )
    strongest_share: float = criterion(
        0.01, "of the strongest spectral line", "a weaker one is not worth an effect", DEVELOPMENT
    )
    resonance_share: float = criterion(
        0.3,
        "of the strongest spectral line",
        "a resonance is simulated where a free spectral line at its coordinate has more",
        DEVELOPMENT,
    )
    idler_step: int = criterion(
        3,
        "idlers",
        "of many the middle one of so many at one wavenumber stands for all until the search is "
        "near",
        "response changes slowly along the web, at the same wavenumber",
    )
    few_idlers: int = criterion(
        8,
        "idlers",
        "where no more are tried, each is tried at once; else every third first",
        "response changes slowly along the web, not so on a short line",
    )
    neighbour_share: float = criterion(
        0.3,
        "of the best score",
        "an effect above this is tried at the neighbours of its two best places",
        DEVELOPMENT,
    )
    neighbour_reach: int = criterion(
        2, "idlers", "how far a neighbour may be", "every third was tried, two reach the rest"
    )
    shortlist_share: float = criterion(
        0.85, "of the best score", "effects below this are not fitted", NOT_RECORDED
    )
    shortlist_share_curved: float = criterion(
        0.15,
        "of the best score",
        "the same for an effect whose response is not proportional to its size",
        "one linear step ranks it badly: a second chance",
    )
    shortlist_floor: float = criterion(
        0.5, "of periodic_score", "nor is any effect below this", DEVELOPMENT
    )
    shortlist_places: int = criterion(3, "places", "of one effect are fitted", DEVELOPMENT)
    shortlist_length: int = criterion(8, "effects", "are fitted in one round", DEVELOPMENT)
    first_size: tuple[float, float] = criterion(
        (0.1, 3.0),
        "typical sizes",
        "between which the fit of a curved effect begins",
        NOT_RECORDED,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptanceCriteria:
    """Which effect is accepted; scores are chi2 less ln(rows / 4) per number [BIC]."""

    score: float = criterion(
        120.0,
        "chi2",
        "least score of an effect without a spectral line of its own",
        "healthy records of other code, and line01, reach 85 to 115",
    )
    later_score: float = criterion(
        400.0,
        "chi2",
        "the most that the same needs beside an effect that was found already; beside a weak one "
        "it is unexplained.remainder_share of what was explained, and ``score`` at least",
        "what a right effect leaves, for its own model is not exact, imitations take up to 330; "
        "a right effect leaves up to 0.04 of what it explains, and 400 is that of 1e4 (cases: 189 "
        "to 289 beside 3e6, 63 beside 990)",
    )
    periodic_score: float = criterion(
        50.0,
        "chi2",
        "least score of an effect at orders of a body; a frequency is chosen among thousands",
        "what a model lacks seldom has the same coordinate; the value: " + DEVELOPMENT,
    )
    beyond_doubt: float = criterion(
        3000.0,
        "chi2",
        "an effect of a higher score is not weighed again at the declared drive tick, nor against "
        "two places together",
        "coarse encoder words rest at speeds that depend on the tick "
        "(docs/engineer/refine-method.md); above, two places only mend what the model has wrong "
        "(ADR 0016)",
    )
    weak: float = criterion(
        150.0,
        "chi2",
        "below, an effect that is not periodic is not claimed when another is within ``margin``",
        DEVELOPMENT,
    )
    margin: float = criterion(
        10.0,
        "chi2",
        "effects whose scores are closer than this are not distinguished",
        "not recorded; it is 2 ln of a Bayes factor of 150, very strong [Kass, Raftery 1995]",
    )
    certain_size: float = criterion(
        14.0,
        "chi2, two degrees of freedom",
        "an effect whose strengths differ from absence by less is no estimate",
        "probability 0.001",
    )
    most_looks: int = criterion(
        3, "effects", "are weighed in one round by what is lost without them", NOT_RECORDED
    )
    explained_share: float = criterion(
        0.001,
        "of what was explained",
        "a further effect must explain more",
        "no model is exact; the value: " + DEVELOPMENT,
    )
    free_term_share: float = criterion(
        0.001,
        "of what free terms took up",
        "an effect beside them must explain more",
        "they leave about this much, at coordinates of their own",
    )
    decisive_share: float = criterion(
        0.8,
        "of what is left",
        "a periodic effect that explains more is taken before other groups are looked at",
        NOT_RECORDED,
    )
    floor_share: float = criterion(
        2e-4,
        "of what was explained",
        "the search ends when what is left beyond noise is surely less",
        "a share of 3e-3 hid a true second effect",
    )
    least_excess: float = criterion(
        225.0,
        "chi2",
        "for decisive_share, what is left beyond noise counts as no less",
        NOT_RECORDED,
    )
    most_effects: int = criterion(4, "effects", "are accepted at most", NOT_RECORDED)
    most_free_terms: int = criterion(2, "rounds", "of search beside free terms", NOT_RECORDED)
    reported_rejected: int = criterion(
        12, "effects", "rejected ones that the report lists", NOT_RECORDED
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class CompletenessCriteria:
    """Whether an effect explains what a free spectral line at its coordinate would."""

    explained_share: float = criterion(
        0.8,
        "of what the free spectral line explains",
        "an effect that is complete explains more",
        DEVELOPMENT,
    )
    left_share: float = criterion(
        0.15,
        "of what the free spectral line explains",
        "an effect that is complete leaves less there",
        DEVELOPMENT,
    )
    fair_share: float = criterion(
        0.3,
        "of all that is left",
        "an effect that is not periodic explains more; so does a periodic one that is claimed "
        "where what is left has no spectral line",
        "the largest of up to three true ones does, an imitation of something else seldom",
    )
    twins_left_share: float = criterion(
        0.01,
        "of what was explained",
        "two effects that are accepted together at one spectral line leave less",
        "their four numbers explain most spectral lines in part; true ones leave the error of the "
        "model, at most 4 model_error",
    )
    sure_sd: float = criterion(
        3.0,
        "standard deviations of a chi-square cost",
        "by which what is left has to exceed noise to be surely more",
        NOT_RECORDED,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class UnexplainedCriteria:
    """What is left over: noise, a spectral line, or something irregular."""

    periodic: float = criterion(
        260.0,
        "chi2, 72 degrees of freedom, best of all bins",
        "a free spectral line above counts, where noise is as unlikely to show it",
        "healthy records stay below; as unlikely: channels that noise moves together count less, "
        "nine are 14 degrees of freedom at 0.5 Hz in seeded runs of another code's lines",
    )
    periodic_degrees: int = criterion(
        72,
        "degrees of freedom",
        "of the spectral line that ``periodic`` is set for",
        "twelve channels, two phases, three powers of speed",
    )
    periodic_share: float = criterion(
        0.12, "of what is left", "a free spectral line above is named as what is left", DEVELOPMENT
    )
    spectral_line_cycles: float = criterion(
        8.0,
        "cycles a record",
        "a slower spectral line may be that of a step",
        "the same as for an alias (spectra.alias_cycles)",
    )
    zone_sd: float = criterion(
        4.0,
        "standard deviations",
        "by so much the amplitude of a line in time has to be more in one zone to name that one",
        "two amplitudes differ by chance by 1.4 of one phase: by 4 in one line of 200",
    )
    ringing_share: float = criterion(
        0.5,
        "of what begins at a moment",
        "a spectral line that explains more is named instead of an event",
        "a resonance that a speed excites; a step has most of its power in a few cycles",
    )
    remainder_share: float = criterion(
        0.04,
        "of what was there without effects",
        "where effects are found, less is not named as unknown",
        "a law that is 20 % off in shape leaves as much; slip of other code leaves 0.03",
    )
    imitated_share: float = criterion(
        0.005,
        "of what was there without effects",
        "beside a periodic effect, one that is not and leaves more, and a fair share, imitates",
        "a model may be wrong by as much of a strong effect; right pairs leave 0.0001",
    )
    loud: float = criterion(
        1.12,
        "power over noise",
        "a channel with more holds something broadband",
        "records without an effect, of other code with coloured noise and late scans: up to 1.05",
    )
    loud_sd: float = criterion(
        4.0,
        "standard deviations of what seeded runs keep",
        "above their mean from which a channel is loud",
        "loud is four to six where noise is the same all the time: 60 s differ by 2 to 3 %",
    )
    coupled: float = criterion(
        20.0,
        "score of coherence, for noise exponential with mean 1",
        "a pair of channels above is moved by something other than noise",
        "36 records without an effect, of other code: the oddest pair has 10.2",
    )
    coupling_bands_Hz: tuple[float, ...] = criterion(
        (0.625, 1.25, 2.5, 5.0, 10.0, 20.0),
        "Hz",
        "edges of the bands in which channels are compared; bands beyond half the sample rate not",
        "below, tolerances move channels together (ADR 0016), by zones and loops, not by samples; "
        "1/80 to 2/5 of half of 100 Hz",
    )
    fewest_bins: int = criterion(
        16, "bins", "a band with fewer is not looked at for coupling", NOT_RECORDED
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeTermCriteria:
    """What a free term takes up."""

    harmonics: Mapping[str, int] = criterion(
        {"angle": 16, "travel": 6, "time": 2},
        "orders",
        "of a free term, by the coordinate of its spectral line",
        NOT_RECORDED,
    )
    half_waves: int = criterion(
        8,
        "half waves over the record",
        "at most, in which the size of a free term may change",
        NOT_RECORDED,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class WanderingCriteria:
    """How an effect whose size is not quite constant may change."""

    interval_s: float = criterion(
        2.0,
        "s",
        "over which its size counts as constant",
        "a roller's hold changes with what lies on it, a zone answers within seconds",
    )
    share: float = criterion(
        0.1, "of its size", "change of size from which a response is taken", "it is linear in that"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ExchangeCriteria:
    """Where effects are tried once all are found, and which are taken out again."""

    reach: int = criterion(
        2, "rollers", "to either side of an effect's place are tried", DEVELOPMENT
    )
    close: int = criterion(3, "places", "with the next best scores are tried again", DEVELOPMENT)
    rounds: int = criterion(4, "Gauss-Newton steps", "of a fit elsewhere", DEVELOPMENT)
    bridle_share: float = criterion(
        0.04,
        "of what was explained",
        "by how much more one effect on an S-wrap may leave than one on each of its rollers",
        "how much a roller slips wanders by as much (search.unexplained.remainder_share)",
    )
    missed: float = criterion(
        40.0,
        "chi2",
        "an effect is taken out if that costs less, beyond the price of its numbers",
        "a search that looks everywhere finds 30 in noise; the value: " + DEVELOPMENT,
    )
    model_error: float = criterion(
        0.005,
        "1",
        "relative error that a model's response may have",
        "0.3 to 1 % between two codes of one line; a rival behind by less than 4 e^2 of what was "
        "explained may be the true one",
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchCriteria:
    """All criteria of the search."""

    screening: ScreeningCriteria = field(default_factory=ScreeningCriteria)
    acceptance: AcceptanceCriteria = field(default_factory=AcceptanceCriteria)
    completeness: CompletenessCriteria = field(default_factory=CompletenessCriteria)
    profile: ProfileCriteria = field(default_factory=ProfileCriteria)
    degeneracy: DegeneracyCriteria = field(default_factory=DegeneracyCriteria)
    unexplained: UnexplainedCriteria = field(default_factory=UnexplainedCriteria)
    free_terms: FreeTermCriteria = field(default_factory=FreeTermCriteria)
    events: EventCriteria = field(default_factory=EventCriteria)
    recurring: RecurringCriteria = field(default_factory=RecurringCriteria)
    sticking: StickingCriteria = field(default_factory=StickingCriteria)
    wandering: WanderingCriteria = field(default_factory=WanderingCriteria)
    exchange: ExchangeCriteria = field(default_factory=ExchangeCriteria)
