"""Heat and moisture in a span: the strain they free and the density they change."""

from __future__ import annotations

import math

from sim_plant.base.jit import compiled


@compiled
def exchange_rate(
    value: float, entering: float, surroundings: float, renewal_1_s: float, time_s: float
) -> float:
    """Return the rate of a span's mean temperature (K/s) or moisture (1/s).

    Equation: dX/dt = (ldot_A / L) (X_in - X) + (X_air - X)/tau   [own derivation: well mixed
    span; the source's chapter 6 asks for thermal and hygral effects]. ``renewal`` = ldot_A / L.
    Never raises.
    """
    return renewal_1_s * (entering - value) + (surroundings - value) / time_s


@compiled
def leaving_value(value: float, surroundings: float, renewal_1_s: float, time_s: float) -> float:
    """Return temperature or moisture at the end of a piece of web with this mean.

    Along web that moves evenly dX/dx = (X_air - X)/(v tau), so X_out - X_air = (X - X_air)
    a/(e^a - 1), a = 1/(renewal tau), of the piece's mean X [own derivation: exact at rest at any
    speed and length of the pieces; well mixed as a goes to 0, the surroundings' as the web
    stands]. Never raises.
    """
    share = min(1.0 / (renewal_1_s * time_s), 500.0)
    kept = share / (math.exp(share) - 1.0) if share > 1e-5 else 1.0 - 0.5 * share
    return surroundings + (value - surroundings) * kept


@compiled
def free_strain(
    expansion_1_K: float, warming_K: float, swelling: float, moisture_change: float
) -> float:
    """Return the strain that pulls nothing: eps_f = alpha dTheta + beta dm.

    T = EA (eps - eps_f) while the mass balance keeps the whole eps. That answers the source's
    question in chapter 6: the length change enters through the tension law, the density change
    through the flow, and neither through the span length.
    """
    return expansion_1_K * warming_K + swelling * moisture_change


@compiled
def mass_per_length(reference_kg_m: float, strain: float) -> float:
    """Return rho A of the web as it runs, kg/m: rho_n A_n / (1 + eps)   [source 2.14].

    eps holds the free strain: warm web is lighter per metre although nothing pulls it, and the
    flow out of a span is (rho A)_i v_i with its own density (source 2.10).
    """
    return reference_kg_m / (1.0 + strain)
