"""An unwind roll that bounces on a soft mandrel."""

from __future__ import annotations

from collections.abc import Mapping

from aff_runtime.base.errors import PlantError
from sim_plant.base.arrays import UNWIND, LineArrays
from sim_plant.base.effects import Effect, Parameter, Quadrature, Value
from sim_plant.base.signatures import said_by
from sim_plant.effects.beside import where_alike
from sim_plant.effects.phasor import component, phasor

FIRST = Quadrature(cos="cos1_kg_m", sin="sin1_kg_m", against=True)
OTHER = Quadrature(cos="cosn_kg_m", sin="sinn_kg_m", order="order", against=True)


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Let the unwind swing along its span: mass, frequency, and unbalance of order 1 and n.

    m x'' = T + u(theta) omega^2 - m w^2 x - 2 zeta m w x'; x' feeds the first span [own]. Without
    mass the mandrel is rigid.
    """
    if int(arrays.bodies["kind"][place]) != UNWIND:
        raise PlantError("roll_bounce.location: only the unwind is modelled on a soft mandrel")
    mass_kg = float(parameters["mass_kg"])
    if mass_kg == 0.0:
        return arrays
    web = arrays.web[0]
    web["bounce_mass_kg"], web["bounce_Hz"] = mass_kg, float(parameters["frequency_Hz"])
    web["bounce_damping"], web["bounce_order"] = (
        float(parameters["damping"]),
        float(parameters["order"]),
    )
    first, other = phasor(parameters, FIRST), phasor(parameters, OTHER)
    web["bounce_cos1_kg_m"] += first.real
    web["bounce_sin1_kg_m"] += first.imag
    web["bounce_cosn_kg_m"] += other.real
    web["bounce_sinn_kg_m"] += other.imag
    return arrays


EFFECT = Effect(
    name="roll_bounce",
    place="body",
    candidates="unwind",
    accepts={
        "mass_kg": Parameter(
            default=0.0,
            unit="kg",
            typical=20.0,
            low=0.0,
            high=10000.0,
            role="shape",
            tries=(20.0,),
        ),
        "frequency_Hz": Parameter(
            default=3.4, unit="Hz", typical=3.4, low=0.2, high=50.0, role="shape"
        ),
        "damping": Parameter(
            default=0.06, unit="1", typical=0.06, low=0.001, high=0.5, role="shape"
        ),
        "order": Parameter(
            default=4.0,
            unit="1",
            typical=4.0,
            low=1.0,
            high=20.0,
            role="option",
            tries=(2.0, 3.0, 4.0, 5.0, 6.0),
        ),
        "cos1_kg_m": component("kg m", 0.02, 2.0),
        "sin1_kg_m": component("kg m", 0.02, 2.0),
        "cosn_kg_m": component("kg m", 0.02, 2.0),
        "sinn_kg_m": component("kg m", 0.02, 2.0),
    },
    fitted=("cos1_kg_m", "sin1_kg_m", "cosn_kg_m", "sinn_kg_m", "frequency_Hz", "damping"),
    fitted_later=("mass_kg",),  # how far a step of tension moves the roll tells it
    quadratures=(FIRST, OTHER),
    apply=apply,
    text="the roll bounces on its mandrel: a fixed frequency that an order of the roll excites",
    shows=said_by("order", rings_at="frequency_Hz", damped_by="damping"),
    beside=where_alike("mass_kg", "frequency_Hz", "damping", "order", absent={"mass_kg": 0.0}),
    remedy="look for play in mandrel and chucks of {place}, or avoid the speed at which it rings",
)
