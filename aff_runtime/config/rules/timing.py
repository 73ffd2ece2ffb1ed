"""Times: a stale PLC ends in zero within 300 ms, the reply fits its tick."""

from __future__ import annotations

from collections.abc import Iterator

from aff_runtime.base.units import plain
from aff_runtime.config.models import Site
from aff_runtime.config.registers import block_of, read_rows, write_rows
from aff_runtime.config.rules.issue import Issue
from aff_runtime.fieldbus.modbus.serial_time import transaction_ms

ZERO_WITHIN_MS = 300.0


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with times."""
    fresh, cycle_ms = site.freshness, site.line.cycle_ms
    total_ms = fresh.fault_after_ms + fresh.fade_ms
    if total_ms > ZERO_WITHIN_MS:
        text = (
            f"fault_after_ms + fade_ms is {plain(total_ms)} ms; zero is due within "
            f"{plain(ZERO_WITHIN_MS)} ms. Lower one of the two."
        )
        yield Issue(path=("freshness", "fade_ms"), text=text)
    if fresh.hold_after_ms >= fresh.fault_after_ms:
        text = f"is not below fault_after_ms {plain(fresh.fault_after_ms)} ms. Lower it."
        yield Issue(path=("freshness", "hold_after_ms"), text=text)
    if fresh.hold_after_ms < 2 * cycle_ms:
        text = f"is under two cycles of {plain(cycle_ms)} ms; one late reply holds. Raise it."
        yield Issue(path=("freshness", "hold_after_ms"), text=text, warning=True)
    if fresh.fault_after_ms < 3 * cycle_ms:
        text = f"is under three cycles of {plain(cycle_ms)} ms. Raise it."
        yield Issue(path=("freshness", "fault_after_ms"), text=text)
    deadline_ms = site.gateway.deadline_ms
    if deadline_ms >= cycle_ms:
        text = (
            f"{plain(deadline_ms)} ms is not below cycle_ms {plain(cycle_ms)} ms; a late reply "
            "would delay the next tick. Lower it."
        )
        yield Issue(path=("gateway", site.gateway.wire, "deadline_ms"), text=text)
    yield from _line_is_fast_enough(site)
    for name, actuator in site.actuators.items():
        velocity = actuator.unit == "m/s"
        amplitude = site.probe.amplitude_m_s if velocity else site.probe.amplitude_N_m
        if amplitude is not None and amplitude > actuator.limit > 0:
            key = "amplitude_m_s" if velocity else "amplitude_N_m"
            text = f"{plain(amplitude)} {actuator.unit} is above the limit of {name}. Lower it."
            yield Issue(path=("probe", key), text=text)
    for missing in ("ESTOP_OK", "WEB_INTACT", "LINE_RUN"):
        if missing not in site.permissives.need:
            text = f"{missing} is not needed for a correction. Add it if the PLC supplies it."
            yield Issue(path=("permissives", "need"), text=text, warning=True)


def _line_is_fast_enough(site: Site) -> Iterator[Issue]:
    """Yield that a serial line is too slow for the transactions of one cycle."""
    rtu = site.gateway.modbus_rtu
    if rtu is None:
        return
    words = block_of(read_rows(site))[1], block_of(write_rows(site))[1]
    needed_ms = transaction_ms(*words, rtu.baud, fc23=rtu.function == "fc23")
    if needed_ms > rtu.deadline_ms:
        text = (
            f"one cycle's frames take {needed_ms:.1f} ms at {rtu.baud} bit/s, deadline_ms is "
            f"{plain(rtu.deadline_ms)}. Raise baud, or deadline_ms and cycle_ms."
        )
        yield Issue(path=("gateway", "modbus_rtu", "deadline_ms"), text=text)
