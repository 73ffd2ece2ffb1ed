"""What the line and the service did in a piece of a run: correcting or not, probing, ramps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aff_runtime.base.probe_columns import EXCITING, STAGE
from aff_runtime.base.signals import State, StateBits
from sim_plant.base.arrays import Array
from sim_plant.refine.criteria.criteria import CRITERIA

RUN = CRITERIA.records.run
LARGEST_STATE_BITS = 2.0**32 - 1.0
"""All bits of ``state_bits`` set."""

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Activity:
    """How long each lasted in a piece, s; probing counts as neither on nor off.

    Attributes
    ----------
    on_s, off_s, probing_s : corrections went out, none did, the probe's excitation did.
    ramp_s : the line speed changed, with up to ``ramp_look_s`` before and after each ramp.
    saturated_s : a limit of the service cut the correction.
    shadow_s : of ``off_s``, the law computed and nothing was sent.
    """

    on_s: float
    off_s: float
    probing_s: float
    ramp_s: float
    saturated_s: float
    shadow_s: float

    def sentences(self) -> list[str]:
        """Return them as they are said of a record."""
        parts = [("AFF on", self.on_s), ("off", self.off_s), ("probing", self.probing_s)]
        said = [", ".join(f"{name} {length:.4g} s" for name, length in parts if length > 0.0)]
        if self.shadow_s > 0.0:
            said.append(
                f"off in shadow, computed and not sent: {self.shadow_s:.3g} s of the time off"
            )
        if self.ramp_s > 0.0:
            said.append(
                f"the line speed changes in {self.ramp_s:.3g} s, "
                f"up to {RUN.ramp_look_s:g} s before and after each ramp included"
            )
        if self.saturated_s > 0.0:
            said.append(
                f"AFF was at a limit for {self.saturated_s:.3g} s: the record holds what went out"
            )
        return said


def activity_of(
    columns: Mapping[str, Array], acted: Sequence[Array], speed_m_s: Array, step_s: float
) -> Activity:
    """Return how long each lasted.

    Parameters
    ----------
    columns : of the run (samples,): ``state``, ``state_bits``, and where there are any the probe's
        stage and ``limit_ratio_...`` of each output.
    acted : the correction of each actuator (samples,), in its own unit; whether it is 0 counts.
    """
    stage = columns.get(STAGE, np.full(speed_m_s.shape, np.nan))
    is_correcting = np.zeros(speed_m_s.shape, dtype=np.bool_)
    for values in acted:
        is_correcting |= values != 0.0
    probing = (stage == EXCITING) & is_correcting
    shadow = columns["state"] == State.SHADOW
    words = np.clip(np.nan_to_num(columns["state_bits"]), 0.0, LARGEST_STATE_BITS)
    limited = (words.astype(np.int64) & int(StateBits.SATURATED)) != 0
    for name, values in columns.items():
        if name.startswith("limit_ratio_"):
            limited |= values < RUN.limited_share
    return Activity(
        on_s=step_s * float(np.sum(is_correcting & ~probing)),
        off_s=step_s * float(np.sum(~is_correcting & ~probing)),
        probing_s=step_s * float(np.sum(probing)),
        ramp_s=step_s * float(np.sum(ramps(speed_m_s, step_s))),
        saturated_s=step_s * float(np.sum(limited & is_correcting)),
        shadow_s=step_s * float(np.sum(shadow & ~is_correcting)),
    )


def ramps(speed_m_s: Array, step_s: float) -> Flags:
    """Return where the line speed (samples,) changes.

    The mean over ``ramp_look_s`` after a sample is compared with that over as long before. Half as
    long at the beginning and at the end of a record never counts.
    """
    reach = max(1, round(0.5 * RUN.ramp_look_s / step_s))
    if speed_m_s.size <= 2 * reach:
        return np.zeros(speed_m_s.shape, dtype=np.bool_)
    smooth = box_mean(speed_m_s, reach)
    change = np.zeros(speed_m_s.shape)
    change[reach:-reach] = np.abs(smooth[2 * reach :] - smooth[: -2 * reach])
    found: Flags = change > RUN.ramp_share * float(np.max(np.abs(smooth)))
    return found


def box_mean(values: Array, reach: int) -> Array:
    """Return the mean over ``reach`` samples to either side, fewer at the ends."""
    total = np.concatenate(([0.0], np.cumsum(values)))
    at = np.arange(values.size)
    low, high = np.maximum(at - reach, 0), np.minimum(at + reach + 1, values.size)
    found: Array = (total[high] - total[low]) / (high - low)
    return found
