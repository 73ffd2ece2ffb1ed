"""The source's laws on plants of known response: sign, phase and clamp decide."""

import cmath
import math

import numpy as np
import pytest

from sim_plant.reproduce.plant_response import PlantResponse, response_of
from sim_plant.reproduce.source_laws import PhasedAff, PrintedAff

OMEGA, DT, SIZE = 6.0, 0.005, 0.3


def ripple_left(law: PrintedAff | PhasedAff, plant: complex, duration_s: float = 60.0) -> float:
    """Return the ripple phasor left of y = Re (D + P W) exp(j psi), a plant without memory.

    The plant turns the phase of the present output: exact while the weights move slowly.
    """
    disturbance = SIZE * cmath.exp(0.7j)
    weight, left = 0j, SIZE
    for k in range(round(duration_s / DT)):
        psi = OMEGA * k * DT
        phasor = disturbance + plant * weight
        y = (phasor * cmath.exp(1j * psi)).real
        law.step(-y, psi, DT)
        w = law.weights[0]
        weight = w if isinstance(law, PhasedAff) else complex(-w.imag, w.real)
        left = abs(phasor)
    return left


@pytest.mark.parametrize("angle_deg", [0.0, 60.0, -60.0])
def test_printed_law_needs_the_plants_real_part_negative(angle_deg: float) -> None:
    plant = -cmath.rect(2.0, math.radians(angle_deg))
    assert ripple_left(PrintedAff(orders=(1,), gain=0.2), plant) < 1e-2 * SIZE
    turned = PrintedAff(orders=(1,), gain=-0.2, limit=50.0)
    assert ripple_left(turned, plant) > 10.0 * SIZE


@pytest.mark.parametrize("angle_deg", [100.0, -100.0])
def test_printed_law_diverges_to_its_clamp_past_ninety_degrees(angle_deg: float) -> None:
    plant = -cmath.rect(2.0, math.radians(angle_deg))
    law = PrintedAff(orders=(1,), gain=0.2, limit=0.5)
    assert ripple_left(law, plant, 120.0) > SIZE
    assert abs(law.weights[0]) == pytest.approx(0.5, rel=0.05)


def test_printed_law_decays_at_g_P_cos_over_two() -> None:
    plant, gain = -cmath.rect(2.0, math.radians(40.0)), 0.05
    rate = gain * 2.0 * math.cos(math.radians(40.0)) / 2.0
    left = ripple_left(PrintedAff(orders=(1,), gain=gain), plant, 40.0)
    assert left == pytest.approx(SIZE * math.exp(-40.0 * rate), rel=0.05)


@pytest.mark.parametrize("angle_deg", [0.0, 90.0, 170.0, -120.0])
@pytest.mark.parametrize("size", [0.5, 300.0])
def test_phased_law_decays_at_its_own_rate_on_any_plant(angle_deg: float, size: float) -> None:
    plant = cmath.rect(size, math.radians(angle_deg))
    flat = response_of(np.array([0.1, 10.0]), np.array([plant, plant]))
    law = PhasedAff(orders=(1,), rate_1_s=0.1, response=flat, limit=10.0)
    left = ripple_left(law, plant, 30.0)
    assert left == pytest.approx(SIZE * math.exp(-3.0), rel=0.05)


def test_response_interpolates_gain_and_phase() -> None:
    found = PlantResponse(
        frequency_Hz=(1.0, 2.0), log_gain=(0.0, math.log(4.0)), phase_rad=(0.0, 1.0)
    )
    assert found.at(1.5) == pytest.approx(cmath.rect(2.0, 0.5))
    assert found.at(9.0) == pytest.approx(cmath.rect(4.0, 1.0))
