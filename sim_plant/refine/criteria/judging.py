"""Criteria of the record held out: what refutes, what confirms."""

from __future__ import annotations

from dataclasses import dataclass

from sim_plant.refine.criteria.criterion import NOT_RECORDED, criterion


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgeCriteria:
    """When a record held out refutes what was found on the records fitted."""

    least_power: float = criterion(
        1.0,
        "of the power of noise, mean over channels",
        "power beyond noise from which a record held out has something to explain, or something "
        "is left there beside effects that leave more than search.unexplained.remainder_share",
        "below, what declared numbers leave within their tolerance is as much",
    )
    refuted_share: float = criterion(
        0.5,
        "of that power beyond noise",
        "effects that leave more of it are refuted, unless the record shows their own response",
        "right effects leave 0.01 to 0.1 (refine-pairs); half is beyond a model's error",
    )
    slope_off: float = criterion(
        0.5,
        "1",
        "a record shows a response if its slope on it is this close to 1, chance included",
        "a response that is there has slope 1, one that is not 0; at 1 - 0.5 and 1 + 0.5 the "
        "effect takes no power away, or lacks a third of its response's size, 1/9 of its power; "
        "below 1 - 0.5, where chance alone is less than 0.5, the record lacks it",
    )
    slope_sd: float = criterion(
        2.0, "standard deviations", "of that slope which count as chance", "95 %"
    )
    slope_blocks: int = criterion(
        20,
        "blocks",
        "of a record, by whose scatter that standard deviation is told",
        "each is longer than noise remembers, 2 s of 40 s, and 20 tell a variance",
    )
    slope_fewest_blocks: float = criterion(
        5.0,
        "blocks",
        "of as much power each, that a response holds at least before it tells a slope",
        "beside slow noise (2 s) of twice its size, a response that is not there is shown in 16 % "
        "of 400 draws in one block, in 0.25 % in five, in none from six on",
    )
    taken_share: float = criterion(
        1.0,
        "of the power that is left beyond noise",
        "beside others, an effect that takes less away from a record held out is not claimed, "
        "unless that record shows its response and it takes more than the others' models can "
        "leave (search.unexplained.remainder_share of what all explain)",
        "what a strong effect's model leaves can be imitated; an imitation takes part of it",
    )
    worse_power: float = criterion(
        0.25,
        "of the power of noise, in one channel of force or speed",
        "beside something unknown, an effect that adds more to a record held out is not there",
        "what is there takes power away wherever it shows; right ones add up to 0.06 (cases)",
    )
    mains_share: float = criterion(
        0.004,
        "of the frequency",
        "how far from the fitted one the mains are sought in a record held out, and from their "
        "name where a spectral line may be their alias",
        "a grid's steady state stays within 0.2 Hz of 50 Hz [ENTSO-E]",
    )
    standing_power: float = criterion(
        0.1,
        "of the power of noise, mean of all channels but angles",
        "an event that takes so much away is there, though it began before what is judged",
        "a steady force counts nothing where zeros are free; noise alone moves the mean by 0.02",
    )
    mains_tries: int = criterion(
        64,
        "per cycle in a record",
        "tries of the frequency of the mains in a record held out",
        "one step is 0.1 rad from one end of the record to the other",
    )
    age_simplex: tuple[tuple[float, float], ...] = criterion(
        ((0.0, 0.0), (0.05, 0.0), (0.08, 0.5)),
        "rad, cm",
        "corners of the first simplex of angle and age of a profile, as steps from those fitted",
        NOT_RECORDED,
    )
    age_corners: float = criterion(
        2e-3, "rad or cm", "corners this close, and age_chi2, end that search", NOT_RECORDED
    )
    age_chi2: float = criterion(
        5.0, "chi2", "costs of corners this close, and age_corners, end that search", NOT_RECORDED
    )
    age_runs: int = criterion(60, "simulations", "of that search at most", NOT_RECORDED)
    finest_grid: tuple[float, ...] = criterion(
        (-0.02, -0.01, 0.0, 0.01, 0.02),
        "s or m",
        "moments tried around the best of search.events.fine_grid in a record held out",
        NOT_RECORDED,
    )
    moment_passes: int = criterion(
        4,
        "passes",
        "over the moments of several events in a record held out, at most",
        "not recorded; one that helps ends with all moments within the finest step",
    )
