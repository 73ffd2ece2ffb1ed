"""What an effect leaves beside what its next best explanation leaves, as a sentence."""

from __future__ import annotations

from collections.abc import Mapping

from aff_runtime.base.channel_units import unit_of_name
from sim_plant.refine.report.verdict import ChannelRms, EffectFinding
from sim_plant.refine.report.wording import place_words


def beside_rival(effect: EffectFinding, errors: Mapping[str, ChannelRms]) -> str:
    """Return the errors with an effect and with its runner-up in its place.

    In the tension in which they differ most, in noise floors; "" where none was judged.
    """
    left = {
        name: rms
        for name, rms in effect.runner_up_rms.items()
        if name.endswith("_N") and name in errors and errors[name].noise_floor > 0.0
    }
    if not left or effect.runner_up is None:
        return ""
    name = max(left, key=lambda c: abs(left[c] - errors[c].after) / errors[c].noise_floor)
    unit = unit_of_name(name)
    return (
        f"On the record judged the error in {name} is {errors[name].after:.3g} {unit} rms with "
        f"{place_words(effect.place)}, {left[name]:.3g} {unit} with "
        f"{place_words(effect.runner_up)} in its place."
    )
