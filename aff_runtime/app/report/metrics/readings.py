"""The answer to ``status`` as metrics; what is old or not known is left out, never a zero.

A sample that is left out ends its curve in the monitoring system: that is what it should show.
"""

from __future__ import annotations

import math
import platform
from collections.abc import Iterator
from dataclasses import dataclass

from aff_runtime import __version__
from aff_runtime.app.report.alarm_table import PRIORITIES
from aff_runtime.app.report.block_status import SHAPE, at_encoder_zero_deg
from aff_runtime.app.report.line_facts import VELOCITY, LineFacts, OutputFacts
from aff_runtime.app.report.status_answer import NOT_SAID, Live, StatusAnswer
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.report.watch_notes import WatchNotes
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.signals import State, Status
from aff_runtime.config.revision import SHORT
from aff_runtime.core.monitor import OrderState
from aff_runtime.core.order_status import OrderStatus
from aff_runtime.telemetry.recorder_messages import RecorderReport

TICK_PATIENCE_S = 1.0  # where the newest tick is older, the control process does not tick
RESTING = {
    OrderState.RISING: "rising",
    OrderState.HELD_PHASE: "phase",
    OrderState.HELD_FREQUENCY: "frequency",
    OrderState.CLAMPED: "limit",
}


@dataclass(frozen=True, slots=True)
class Sample:
    """One number of a metric, with the values of its labels in the catalogue's order."""

    metric: str
    labels: tuple[str, ...]
    value: float


@dataclass(frozen=True, slots=True)
class MetricHistogram:
    """A histogram: what was counted up to each edge, and the sum of all.

    Attributes
    ----------
    buckets : (upper edge, count of all up to it), by edge; the last edge is infinite.
    """

    metric: str
    buckets: tuple[tuple[float, float], ...]
    total: float


def readings(
    answer: StatusAnswer | None, now_ns: int, watch: WatchNotes | None = None
) -> tuple[Sample, ...]:
    """Return every sample whose value is known now.

    Parameters
    ----------
    answer : None when no service answers.
    now_ns : monotonic time, of the machine on which the service runs.
    watch : what `aff-runtime watch` found of this line; None where it does not look.
    """
    said = (*_samples(answer, now_ns), *_watched(watch))
    return tuple(sample for sample in said if math.isfinite(sample.value))


def _watched(watch: WatchNotes | None) -> Iterator[Sample]:
    if watch is not None:
        yield Sample("aff_watch_notes", (), float(len(watch.notes)))
        yield Sample("aff_watch_timestamp_seconds", (), watch.looked_s)


def _samples(answer: StatusAnswer | None, now_ns: int) -> Iterator[Sample]:
    yield Sample("aff_build_info", (__version__, platform.python_version()), 1.0)
    live = answer.live if answer is not None and _ticks(answer.live, now_ns) else None
    yield Sample("aff_control_up", (), float(live is not None))
    if answer is None:
        return
    if answer.config_hash:
        yield Sample("aff_config_info", (answer.config_hash[:SHORT],), 1.0)
    yield Sample("aff_config_differs", (), float(bool(answer.config_differs)))
    if answer.control_restarts != NOT_SAID:
        yield Sample("aff_control_restarts_total", (), answer.control_restarts)
    if answer.audit_records != NOT_SAID:
        yield Sample("aff_audit_records_total", (), answer.audit_records)
    if answer.audit_ok != NOT_SAID:
        yield Sample("aff_audit_chain_ok", (), answer.audit_ok)
    for one in answer.commands:
        yield Sample("aff_commands_total", (one.action, one.via, one.result), one.count)
    for probe in answer.probes:
        of = (probe.actuator,)
        yield Sample("aff_probe_timestamp_seconds", of, _known(probe.measured_utc_s))
        yield Sample("aff_probe_coherence_lowest_ratio", of, probe.coherence_lowest)
        highest_rad = probe.phase_error_highest_rad
        yield Sample("aff_probe_phase_error_highest_radians", of, highest_rad)
    yield from _recorder(answer.recorder)
    if live is None:
        return
    yield from _guard(answer.state, live)
    yield from _ticking(live)
    for meeting in answer.meetings:
        yield Sample("aff_next_order_meeting_seconds", (meeting.actuator,), meeting.time_s)
    if answer.facts is not None:
        yield from _line(answer.facts, live.tick)
        yield from _orders(answer.facts, live.tick)


def tick_age_s(live: Live, now_ns: int) -> float:
    """Return how long ago the newest tick began, s; NaN when that is not known."""
    return live.tick.tick_age_s(live.meta.start_ns, now_ns)


def _ticks(live: Live | None, now_ns: int) -> bool:
    return live is not None and tick_age_s(live, now_ns) < TICK_PATIENCE_S


def _recorder(recorder: RecorderReport | None) -> Iterator[Sample]:
    yield Sample("aff_recorder_up", (), float(recorder is not None and recorder.alive))
    if recorder is not None:
        yield Sample("aff_recorder_rows_total", (), recorder.rows)
        yield Sample("aff_recorder_rows_lost_total", (), recorder.rows_lost)
        yield Sample("aff_ring_overruns_total", ("recorder",), recorder.ring_overruns)
        yield Sample("aff_recordings_bytes", (), _said(recorder.kept_bytes))
        yield Sample("aff_recordings_limit_bytes", (), _said(recorder.max_bytes))
        yield Sample("aff_disk_free_bytes", (), _said(recorder.free_bytes))


def _guard(state: str, live: Live) -> Iterator[Sample]:
    for one in State:
        yield Sample("aff_guard_state", (one.name,), float(one.name == state))
    for name, priority in PRIORITIES.items():
        yield Sample("aff_alarm_active", (name, priority.value), float(live.alarm.name == name))


def _ticking(live: Live) -> Iterator[Sample]:
    timing = live.tick.timing
    yield Sample("aff_ticks_total", (), live.tick.number("tick") + 1.0)
    yield Sample("aff_ticks_missed_total", (), _known(timing.missed_count))
    yield Sample("aff_plc_heartbeat_age_seconds", (), _known(timing.plc_age_s))
    for right in live.meta.rights:
        name = right.text.split(":", maxsplit=1)[0]
        yield Sample("aff_realtime_right_granted", (name,), float(right.granted))


def _line(facts: LineFacts, tick: TickRow) -> Iterator[Sample]:
    if tick.plc_age_s <= facts.fault_after_s:
        yield from _measured(facts, tick)
    for output in facts.outputs:
        kind = "meters_per_second" if output.unit == VELOCITY else "newton_meters"
        of, row = (output.actuator,), tick.number
        yield Sample(f"aff_correction_{kind}", of, row(f"correction_{output.column}"))
        yield Sample(f"aff_correction_limit_{kind}", of, output.limit)
        yield Sample("aff_correction_applied_ratio", of, row(f"applied_ratio_{output.column}"))
        yield Sample("aff_correction_scaled_ratio", of, row(f"limit_ratio_{output.column}"))


def _measured(facts: LineFacts, tick: TickRow) -> Iterator[Sample]:
    """Yield what was read from the PLC in this tick."""
    for name in facts.permissives:
        yield Sample("aff_permissive_ok", (name,), float(bool(tick.status_word & Status[name])))
    for channel in tick.channels:
        if channel.is_of("_N"):
            kind = "tension_reference" if channel.name in facts.references else "tension"
            yield Sample(f"aff_{kind}_newtons", (channel.name,), _known(channel.value))
        elif channel.is_of("_m_s"):
            yield Sample("aff_speed_meters_per_second", (channel.name,), _known(channel.value))
    for roll in facts.rolls:
        fixed = math.nan if roll.radius_m is None else roll.radius_m
        radius_m = tick.number(roll.radius_channel) if roll.radius_channel else fixed
        yield Sample("aff_roll_radius_meters", (roll.name,), radius_m)
        omega_rad_s = tick.roll(roll.name).omega_rad_s
        yield Sample("aff_roll_speed_radians_per_second", (roll.name,), omega_rad_s)


def _orders(facts: LineFacts, tick: TickRow) -> Iterator[Sample]:
    outputs = {output.actuator: output for output in facts.outputs}
    angles = {roll.name: roll.angle_channel for roll in facts.rolls}
    frequencies: dict[tuple[str, str], float] = {}
    for order in tick.orders():
        output = outputs.get(order.actuator)
        drive_roll = output.drive_roll if output is not None else ""
        roll = drive_roll if order.is_imbalance else order.roll
        frequency_Hz = order.order * tick.roll(roll).omega_rad_s / math.tau
        frequencies[roll, str(order.order)] = frequency_Hz
        # an imbalance has the order 1 of its roll: its own name keeps the two apart
        name = order.name if order.is_imbalance else str(order.order)
        of = (order.actuator, roll, name)
        yield from _order(of, order, output)
        if order.law == SHAPE and not order.is_imbalance:
            angle_rad = math.radians(at_encoder_zero_deg(tick, roll, angles.get(roll), order))
            yield Sample("aff_roll_deviation_meters", of, 1e-3 * order.size)
            yield Sample("aff_roll_deviation_angle_radians", of, angle_rad)
    for labels, value in frequencies.items():
        yield Sample("aff_order_frequency_hertz", labels, value)


def _order(
    of: tuple[str, str, str], order: OrderStatus, output: OutputFacts | None
) -> Iterator[Sample]:
    """Yield ripple, share and rest of one order; ``of`` : its labels."""
    before, now = order.ripple_before, order.ripple
    unit = _unit_of(output.signal) if output is not None else ""
    if unit:
        yield Sample(f"aff_order_ripple_{unit}", (*of, "without"), before)
        yield Sample(f"aff_order_ripple_{unit}", (*of, "now"), now)
    yield Sample("aff_order_remaining_ratio", of, now / before if before > 0.0 else math.nan)
    if order.law == SHAPE:
        yield Sample("aff_order_share_ratio", of, order.share)
        yield Sample("aff_order_response_ratio", of, order.response_ratio)
    if order.state in RESTING:
        yield Sample("aff_order_resting", (*of, RESTING[order.state]), 1.0)


def _unit_of(signal: str) -> str:
    """Return the unit of a channel as names of metrics have it; empty for any other."""
    return {"N": "newtons", "m/s": "meters_per_second"}.get(unit_of_channel(signal) or "", "")


def _said(count: int) -> float:
    """Return a count of the recorder; NaN where it says none."""
    return math.nan if count == NOT_SAID else float(count)


def _known(value: float | None) -> float:
    return math.nan if value is None else value
