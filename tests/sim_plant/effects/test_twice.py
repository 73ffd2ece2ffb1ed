"""Two effects of one kind at one place: both act, or the line is refused."""

from __future__ import annotations

import cmath

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Parameter, Value
from sim_plant.effects.catalogue import CATALOGUE
from sim_plant.line.arrays.build import build_arrays, timing_of
from sim_plant.line.arrays.locations import candidate_locations
from sim_plant.line.arrays.with_effects import apply_effects
from sim_plant.line.declared.declaration import EffectEntry
from tests.each_case import each_case
from tests.sim_plant.effects.running import effect, euclid

STRENGTHS = [
    (row, name)
    for row in CATALOGUE
    for name, parameter in row.accepts.items()
    if parameter.role == "strength" and not parameter.detail
]


def put(*effects: EffectEntry) -> LineArrays:
    line = euclid()
    return apply_effects(line, build_arrays(line, timing_of(line, line.sample_time_s)), effects)


def numbers(arrays: LineArrays) -> list[np.ndarray]:  # type: ignore[type-arg]
    """Return all numbers of a line; rows that one adds to another in their own order."""
    found = []
    for name, part in arrays._asdict().items():
        rows = np.array([list(row) for row in part.tolist()] if part.dtype.names else part)
        if name in ("ripples", "changes") and rows.size:
            rows = rows[np.lexsort(rows.T)]
        found.append(rows)
    return found


def same(one: LineArrays, other: LineArrays) -> bool:
    return all(
        a.shape == b.shape and np.allclose(a, b, rtol=1e-9, atol=1e-15)
        for a, b in zip(numbers(one), numbers(other), strict=True)
    )


def otherwise(parameter: Parameter) -> Value:
    """Return another value of a number or word that makes no effect by itself."""
    if parameter.tries:
        return parameter.tries[-1]
    if isinstance(parameter.default, str):
        return parameter.default
    return min(max(1.5 * parameter.default, parameter.low), parameter.high)


def one_of(row: Effect, name: str, share: float, *, other: bool) -> EffectEntry:
    """Return an effect of this strength at a share of its typical size."""
    given = row.accepts[name]
    values: dict[str, float | str] = {
        k: p.typical for k, p in row.accepts.items() if k in row.fitted_later
    }
    if other:
        values = {k: otherwise(p) for k, p in row.accepts.items() if p.role != "strength"}
    values[name] = float(given.default) + share * (given.typical - float(given.default))
    return effect(row.name, candidate_locations(euclid(), row)[0], **values)


@pytest.mark.parametrize("other", [False, True], ids=["alike", "otherwise"])
@pytest.mark.parametrize(("row", "name"), STRENGTHS, ids=lambda x: getattr(x, "name", x))
@pytest.mark.sweep(every=3)
def test_neither_of_two_effects_at_one_place_is_lost(row: Effect, name: str, other: bool) -> None:
    one, two = one_of(row, name, 1.0, other=False), one_of(row, name, 0.5, other=other)
    said = ""
    try:
        both = put(one, two)
    except PlantError as error:
        said = str(error)
    if said:
        assert said.startswith(f"effects.1: {row.name} at {one.location} is there already")
        return
    assert same(both, put(two, one))
    assert not same(both, put(one))
    assert not same(both, put(two))


def hum(frequency_Hz: float, amplitude_N: float, phase_rad: float) -> EffectEntry:
    return effect(
        "mains_hum", "R9", frequency_Hz=frequency_Hz, amplitude_N=amplitude_N, phase_rad=phase_rad
    )


def test_hum_of_one_frequency_adds_as_phasors() -> None:
    cell = put(hum(50.0, 1.0, 0.3), hum(50.0, 0.5, 1.7)).cells[0]
    found = cmath.rect(cell["hum_N"], -cell["hum_phase_rad"])
    assert found == pytest.approx(cmath.rect(1.0, 0.3) + cmath.rect(0.5, 1.7), rel=1e-12)
    assert cell["hum_Hz"] == 50.0


def test_an_encoder_off_its_centre_twice_is_off_by_the_sum() -> None:
    first = effect("encoder_eccentricity", "unwind", cos=0.01, sin=0.002)
    drive = put(first, effect("encoder_eccentricity", "unwind", sin=0.001)).drives[0]
    found = cmath.rect(drive["encoder_offset_ratio"], -drive["encoder_angle_rad"])
    assert found == pytest.approx(0.01 + 0.003j, rel=1e-12)


def test_slip_above_one_speed_adds_and_so_do_splice_and_seam_at_one_length() -> None:
    slips = [effect("slip", "pull_roll", slope_s_m=s, threshold_m_s=0.4) for s in (2e-3, 1e-2)]
    assert put(*slips).bodies["slip_s_m"].max() == pytest.approx(1.2e-2, rel=1e-12)
    web = put(
        effect("splice", "web", EA_factor=0.9, at_length_m=30.0),
        effect("splice", "web", EA_factor=0.8, step_m=2e-4, piece_m=0.1, at_length_m=30.0),
    ).web
    assert web["splice_EA_ratio"][0] == pytest.approx(0.72, rel=1e-12)
    assert (web["splice_m"][0], web["splice_step_m"][0]) == (30.0, 2e-4)


@each_case(
    ("first", "second", "said"),
    [
        (
            hum(50.0, 1.0, 0.0),
            hum(100.0, 0.5, 0.0),
            "effects.1: mains_hum at R9 is there already, with frequency_Hz 50.0",
        ),
        (
            effect("mains_hum", "all", amplitude_N=1.0),
            hum(60.0, 0.5, 0.0),
            "effects.1: mains_hum at R9 is there already",
        ),
        (
            effect("splice", "web", EA_factor=0.9, at_length_m=10.0),
            effect("splice", "web", EA_factor=0.8, at_length_m=50.0),
            "effects.1: splice at web is there already, at 10.0 m",
        ),
        (
            effect("shaft_compliance_backlash", "unwind", compliance_rad_N_m=6e-3),
            effect("shaft_compliance_backlash", "unwind", backlash_rad=3e-3),
            "effects.1: shaft_compliance_backlash at unwind is there already",
        ),
        (
            effect("load_cell_filter", "R9", lag_s=0.02),
            effect("load_cell_filter", "R9", corner_Hz=3.0),
            "effects.1: load_cell_filter at R9 is there already",
        ),
        (
            effect("slip", "swrap", slope_s_m=2e-3, threshold_m_s=0.4),
            effect("slip", "swrap_lead", slope_s_m=2e-3, threshold_m_s=1.2),
            "effects.1: slip at swrap_lead is there already",
        ),
    ],
)
def test_what_does_not_add_is_refused_with_its_number_and_place(
    first: EffectEntry, second: EffectEntry, said: str
) -> None:
    with pytest.raises(PlantError) as caught:
        put(first, second)
    assert said in str(caught.value)


def test_limits_of_different_parts_of_a_drive_are_two() -> None:
    drive = put(
        effect("rate_limit", "unwind", slew_m_s2=0.1),
        effect("rate_limit", "unwind", slew_m_s2=0.2, limits="correction"),
    ).drives[0]
    assert (drive["slew_m_s2"], drive["correction_slew_m_s2"]) == (0.1, 0.2)


def test_an_effect_that_is_absent_is_not_in_the_way() -> None:
    assert same(put(hum(100.0, 0.0, 0.0), hum(50.0, 1.0, 0.0)), put(hum(50.0, 1.0, 0.0)))
