"""Step 7: repeats against their stated error; coherence and sign; three places, twice each."""

import cmath
import math

import numpy as np
import pytest

from aff_runtime.app.card.figures import Verdict
from aff_runtime.app.card.measure import response
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.app.card.measure.recorded import evidence, figure
from tests.each_case import each_case

FREQUENCIES = np.linspace(0.3, 8.0, 16)
DELAY_S, ERROR = 0.03, 0.05
SIGNS = ["sign_unwind=-1", "sign_swrap_follower=-1"]
BOTH = frozenset({"unwind", "swrap_follower"})


def probed(
    speed, seed, size=ERROR, coherence=0.97, sign=-1.0, radius=0.2, error=ERROR, at=FREQUENCIES
):
    """Return a probe of sign * 100 / (1 + jf) with a delay, off by ``size`` of itself."""
    rng = np.random.default_rng(seed)
    points = []
    for f in at:
        true = sign * 100.0 / (1.0 + 1j * f) * cmath.exp(-1j * math.tau * f * DELAY_S)
        noise = complex(*rng.standard_normal(2)) / math.sqrt(2.0)
        value = true * (1.0 + size * noise)
        points.append(
            ResponsePoint(
                frequency_Hz=float(f),
                gain=abs(value),
                phase_rad=cmath.phase(value),
                relative_error=error,
                coherence=coherence,
            )
        )
    about = Provenance(actuator="unwind", signal="s", line_speed_m_s=speed, radius_m=radius)
    return Response(points=points, delay_s=DELAY_S, provenance=about)


def taken(probes, given=(*SIGNS,)):
    """Return what step 7 says after each of these probes, one measurement each."""
    former = ()
    for one in probes:
        found = response.measure(
            evidence(
                given=given,
                responses={"unwind": one, "swrap_follower": one},
                probed_here=BOTH,
                former=former,
            )
        )
        former = (*former, *found.samples)
    return found


def six(**how):
    return [probed(v, 10 * k + n, **how) for k, v in enumerate((0.5, 1.0, 1.5)) for n in (0, 1)]


def test_three_speeds_twice_with_their_stated_error_pass():
    found = taken(six())
    assert found.verdict is Verdict.PASS
    assert figure(found, "unwind: speeds or radii probed twice").value == 3.0
    assert figure(found, "unwind: sign").value == -1.0
    assert found.missing == ()


def test_repeats_are_apart_by_one_where_the_stated_error_is_right():
    found = [
        response.repeat_sigmas(probed(1.0, seed), probed(1.0, seed + 1000)) for seed in range(100)
    ]
    assert np.sqrt(np.mean(np.square(found))) == pytest.approx(1.0, abs=0.08)


def test_what_lies_between_two_tones_is_not_compared_where_both_have_tones_in_common():
    """The second has a tone in the middle of two of the first, where a straight line is off."""
    wide = np.array([0.3, 0.5, 0.7, 0.9, 1.1, 1.5, 2.0, 2.5, 3.0, 8.0])
    moved = np.append(np.delete(wide, 8), 5.0)
    how = {"size": 1e-4, "error": 1e-4}
    first, second = probed(1.0, 1, at=wide, **how), probed(1.0, 2, at=moved, **how)
    assert response.repeat_sigmas(first, second) < 1.6
    few = probed(1.0, 3, at=moved[-3:], **how)  # it has no other
    assert response.repeat_sigmas(first, few) > 10.0


def test_an_error_that_is_stated_three_times_too_small_fails():
    found = taken(six(size=3.0 * ERROR))
    assert figure(found, "unwind: difference of repeats").value > 2.0
    assert found.verdict is Verdict.FAIL


def test_low_coherence_at_an_order_and_the_wrong_sign_fail():
    low = taken(six(coherence=0.7))
    worst = figure(low, "unwind: lowest coherence")
    assert worst.value == pytest.approx(0.7)
    assert worst.name.endswith("(unwind 1x at 0.398 Hz)")  # 0.5 m/s over 2 pi 0.2 m
    assert any("probe louder or longer" in text for text in low.remarks)
    assert low.verdict is Verdict.FAIL
    wrong = taken(six(sign=1.0))
    assert figure(wrong, "unwind: sign").good is False
    assert taken(six(), given=()).verdict is Verdict.OPEN  # no sign was typed


def test_what_is_still_to_be_probed_is_said():
    found = taken(six()[:3])
    assert found.verdict is Verdict.OPEN
    assert "unwind: once more at 1 m/s, radius 0.2 m" in found.missing
    assert "unwind: 1 more speeds or radii" in found.missing


def test_the_same_response_twice_is_one_probe():
    one = probed(1.0, 1)
    found = taken([one, one])
    assert found.samples == ()
    assert figure(found, "unwind: speeds or radii probed twice").value == 0.0


def test_places_differ_by_speed_or_radius_and_none_is_known_without_them():
    found = taken(
        [probed(1.0, 1), probed(1.02, 2), probed(1.0, 3, radius=0.3), probed(math.nan, 4)]
    )
    assert figure(found, "unwind: speeds or radii probed twice").value == 1.0


def test_a_response_that_was_brought_from_outside_is_remarked():
    one = probed(1.0, 1)
    found = response.measure(evidence(given=SIGNS, responses={"unwind": one}))
    assert any("does not say of every response" in text for text in found.remarks)
    assert any("aff-runtime probe" in text for text in found.missing)


@each_case("sign", [-1.0, 1.0])
@each_case("corner_Hz", [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 5.0])
def test_the_sign_is_that_of_all_low_tones_and_undecided_near_90_degrees(corner_Hz, sign):
    """P = sign / (1 + j f / f0) with a delay: cos(arg P) = 1 / sqrt(1 + (f / f0)^2)."""
    points = [
        ResponsePoint(
            frequency_Hz=float(f),
            gain=1.0,
            phase_rad=cmath.phase(
                sign * cmath.exp(-1j * math.tau * f * DELAY_S) / (1 + 1j * f / corner_Hz)
            ),
            relative_error=ERROR,
            coherence=0.97,
        )
        for f in FREQUENCIES
    ]
    about = Provenance(actuator="unwind", signal="s", line_speed_m_s=1.0, radius_m=0.2)
    one = Response(points=points, delay_s=DELAY_S, provenance=about)
    low = np.array([f for f in FREQUENCIES if f <= 3.0 * FREQUENCIES[0]]) / corner_Hz
    mean = float(np.mean(1.0 / np.sqrt(1.0 + low**2)))
    found = taken([one], given=(f"sign_unwind={sign:+.0f}", f"sign_swrap_follower={sign:+.0f}"))
    seen = figure(found, "unwind: sign")
    undecided = [text for text in found.missing if "no sign can be told" in text]
    if mean < 0.2:
        assert (seen.value, seen.good, len(undecided)) == (0.0, None, 2)
    else:
        assert (seen.value, seen.good, undecided) == (sign, True, [])
    across = float(np.mean(low / np.sqrt(1.0 + low**2)))
    turned = -math.degrees(math.atan2(across, mean))
    wanted = turned if sign > 0.0 else turned + 180.0
    assert f"phase {wanted:.0f} deg up to" in seen.name
