"""The verdict as one frozen value, and version 1 of it as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from aff_runtime.base.errors import PlantError
from sim_plant.base.effects import Value
from sim_plant.refine.model.effect_at import EffectAt
from sim_plant.refine.report.plain import plain

VERSION = 1
"""Of the form of verdict.json."""
Coordinate = Mapping[str, float | str]
"""Where something is, by name."""
Answer = Literal["nothing", "traced", "not_identifiable", "unknown"]


def effects_word(answer: Answer) -> str:
    """Return the word before the effects of a headline.

    ``Traced`` would say that nothing else is left: under ``unknown`` they were but found.
    """
    return "Found" if answer == "unknown" else "Traced"


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """When something begins: s from the start of a record fitted.

    Attributes
    ----------
    record : file name of that record.
    record_index : which of those fitted it is, from 0.
    """

    record: str
    time_s: float
    record_index: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberChange:
    """What a declared number was and became, with the ends of its interval, in its own unit."""

    before: float
    after: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectFinding:
    """One effect that was found.

    Attributes
    ----------
    place : effect and location; an effect that version 1 (keys and words of ``verdict.json``) does
        not know goes by its name in the catalogue.
    parameters : as a declaration takes them; a cosine and a sine part also as amplitude and angle.
    interval95 : low and high, 95 %, of the parameters fitted and of those that no record shows.
    score : by how much it reduces chi-square, less the penalty of its numbers.
    margin : by how much the score of the next best explanation is behind.
    runner_up : the next best explanation, if there is one.
    cancel : whether a drive can cancel it by feed-forward.
    text : what the effect is, a sentence without a stop.
    cells : channels of the line's load cells, in the order in which it declares them; a file of
        version 1 has none.
    begins : when an effect that begins at a moment does; not in a file of version 1 either.
    becomes : of a declared number that changes, its values; not in a file of version 1 either.
    runner_up_rms : error by channel on the record judged with the runner-up in its place, all else
        fitted again; empty where that was not judged.
    """

    place: EffectAt
    parameters: Mapping[str, Value]
    interval95: Mapping[str, tuple[float, float]]
    score: float
    runner_up: EffectAt | None
    margin: float
    cancel: bool
    text: str
    cells: tuple[str, ...] = ()
    begins: Moment | None = None
    becomes: NumberChange | None = None
    runner_up_rms: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class UnknownFinding:
    """Something that no effect of the library explains.

    Attributes
    ----------
    unknown_class : ``time``, ``travel``, ``angle``, ``event``, ``state`` or ``broadband``.
    coordinate : where it is, by name.
    chi2_reduction : chi-square that a free term would explain.
    begins : when an event does; not in a file of version 1.
    also : classes and coordinates that the records do not tell from it.
    """

    unknown_class: str
    coordinate: Coordinate
    chi2_reduction: float
    begins: Moment | None = None
    also: tuple[tuple[str, Coordinate], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ambiguity:
    """An effect that the record does not tell from others, and what on the machine would."""

    place: EffectAt
    alternatives: tuple[EffectAt, ...]
    experiments: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ChannelRms:
    """Error of one channel, rms in its unit: as declared, as amended, and of noise alone."""

    before: float
    after: float
    noise_floor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What was found, and what it is worth on the record judged.

    Attributes
    ----------
    answer : ``nothing``, ``traced``, ``not_identifiable`` or ``unknown``.
    residual_rms : error by channel on ``holdout``, the path of the record judged.
    """

    answer: Answer
    effects: tuple[EffectFinding, ...]
    unknown: tuple[UnknownFinding, ...]
    ambiguous: tuple[Ambiguity, ...]
    residual_rms: Mapping[str, ChannelRms]
    holdout: str

    def names(self, place: EffectAt) -> bool:
        """Whether ``place`` was traced, or cannot be told from a traced one by the record."""
        alike = (p for a in self.ambiguous for p in a.alternatives)
        return place in (*(e.place for e in self.effects), *alike)

    def to_json(self) -> str:
        """Return version 1, one key a line."""
        data = {
            "version": VERSION,
            "verdict": self.answer,
            "effects": [_effect_row(e) for e in self.effects],
            "unknown": [
                {
                    "class": u.unknown_class,
                    "coordinate": u.coordinate,
                    "strength": u.chi2_reduction,
                    **_alternatives(u),
                }
                for u in self.unknown
            ],
            "ambiguous": [
                {
                    "effect": str(a.place),
                    "with": [*map(str, a.alternatives)],
                    "experiments": a.experiments,
                }
                for a in self.ambiguous
            ],
            "residual_rms": rms_rows(self.residual_rms),
            "holdout": self.holdout,
        }
        return json.dumps(plain(data), indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Verdict:
        """Return the verdict that a file of version 1 holds.

        Raises
        ------
        PlantError
            When it is no verdict of version 1; the message says what is wrong.
        """
        try:
            data = json.loads(text)
            _check(data)
            return cls(
                answer=data["verdict"],
                effects=tuple(map(_effect_of, data["effects"])),
                unknown=tuple(map(_unknown_of, data["unknown"])),
                ambiguous=tuple(map(_ambiguity_of, data["ambiguous"])),
                residual_rms={
                    name: ChannelRms(**row) for name, row in data["residual_rms"].items()
                },
                holdout=data["holdout"],
            )
        except KeyError as error:
            raise PlantError(f"verdict: {error.args[0]} is missing") from error
        except (TypeError, ValueError, AttributeError) as error:
            raise PlantError(f"verdict: no verdict of version {VERSION} ({error})") from error


def _check(data: Any) -> None:
    """Raise PlantError for another schema or an answer that is none."""
    if "schema" in data:
        raise PlantError(
            f"verdict: schema: read {data['schema']!r}; expected none: this one is of a line"
        )
    if data["version"] != VERSION:
        raise PlantError(
            f"verdict: version: read {data['version']!r}; expected {VERSION}, "
            "as this program writes it"
        )
    if data["verdict"] not in get_args(Answer):
        expected = get_args(Answer)
        raise PlantError(f"verdict: verdict: read {data['verdict']!r}; expected one of {expected}")


def _alternatives(u: UnknownFinding) -> dict[str, list[dict[str, str | Coordinate]]]:
    """Return what the records do not tell from an unknown, as a key of it where there is any."""
    also: list[dict[str, str | Coordinate]] = [
        {"class": kind, "coordinate": where} for kind, where in u.also
    ]
    return {"alternatives": also} if also else {}


def _unknown_of(row: Any) -> UnknownFinding:
    return UnknownFinding(
        unknown_class=row["class"],
        coordinate=row["coordinate"],
        chi2_reduction=row["strength"],
        also=tuple((a["class"], a["coordinate"]) for a in row.get("alternatives", ())),
    )


def _ambiguity_of(row: Any) -> Ambiguity:
    return Ambiguity(
        place=EffectAt.parse(row["effect"]),
        alternatives=tuple(map(EffectAt.parse, row["with"])),
        experiments=tuple(row["experiments"]),
    )


def rms_rows(errors: Mapping[str, ChannelRms]) -> dict[str, dict[str, float]]:
    """Return errors by channel as version 1 has them."""
    return {
        name: {"before": e.before, "after": e.after, "noise_floor": e.noise_floor}
        for name, e in errors.items()
    }


def _effect_row(e: EffectFinding) -> dict[str, Any]:
    return {
        "effect": e.place.effect,
        "location": e.place.location,
        "parameters": e.parameters,
        "interval95": e.interval95,
        "score": e.score,
        "runner_up": str(e.runner_up) if e.runner_up else "",
        "margin": e.margin,
        "cancel": e.cancel,
        "text": e.text,
        **({"runner_up_rms": e.runner_up_rms} if e.runner_up_rms else {}),
    }


def _effect_of(row: Mapping[str, Any]) -> EffectFinding:
    return EffectFinding(
        place=EffectAt(row["effect"], row["location"]),
        parameters=row["parameters"],
        interval95={name: (low, high) for name, (low, high) in row["interval95"].items()},
        score=row["score"],
        runner_up=EffectAt.parse(row["runner_up"]) if row["runner_up"] else None,
        margin=row["margin"],
        cancel=row["cancel"],
        text=row["text"],
        runner_up_rms=dict(row.get("runner_up_rms", {})),
    )
