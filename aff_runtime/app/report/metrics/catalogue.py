"""Every metric by name: kind, labels, meaning. Names carry their SI unit, as Prometheus asks.

Labels are closed sets: names of the site file, of events, states and permissives. No user, path
or sentence is one.
"""

from __future__ import annotations

from dataclasses import dataclass

GAUGE, COUNTER, INFO, HISTOGRAM = "gauge", "counter", "info", "histogram"


@dataclass(frozen=True, slots=True)
class Metric:
    """One family of samples.

    Attributes
    ----------
    name : as it stands in the text, suffix of the unit or kind included.
    kind : ``GAUGE``, ``COUNTER``, ``INFO`` or ``HISTOGRAM``.
    """

    name: str
    kind: str
    labels: tuple[str, ...]
    text: str


_ORDER = ("actuator", "roll", "order")

OF_SERVICE: tuple[Metric, ...] = (
    Metric("aff_build_info", INFO, ("version", "python"), "what runs"),
    Metric("aff_config_info", INFO, ("revision",), "revision of the running configuration"),
    Metric("aff_control_up", GAUGE, (), "1 while the control process ticks"),
    Metric("aff_recorder_up", GAUGE, (), "1 while a recorder runs"),
    Metric("aff_guard_state", GAUGE, ("state",), "1 for the state of the guard"),
    Metric("aff_alarm_active", GAUGE, ("alarm", "priority"), "1 for the alarm that stands"),
    Metric("aff_config_differs", GAUGE, (), "1 while the site file is not what runs"),
    Metric("aff_permissive_ok", GAUGE, ("permissive",), "1 while the PLC gives it"),
    Metric("aff_ticks_total", COUNTER, (), "ticks since the control process began"),
    Metric("aff_ticks_missed_total", COUNTER, (), "ticks that never happened"),
    Metric("aff_plc_heartbeat_age_seconds", GAUGE, (), "age of the PLC's data"),
    Metric("aff_tension_newtons", GAUGE, ("channel",), "tension as read"),
    Metric("aff_tension_reference_newtons", GAUGE, ("channel",), "set point of a tension"),
    Metric("aff_speed_meters_per_second", GAUGE, ("channel",), "surface speed as read"),
    Metric("aff_roll_radius_meters", GAUGE, ("roll",), "radius as read or declared"),
    Metric("aff_roll_speed_radians_per_second", GAUGE, ("roll",), "how fast a roll turns"),
    Metric("aff_order_frequency_hertz", GAUGE, ("roll", "order"), "frequency of an order"),
    Metric("aff_order_ripple_newtons", GAUGE, (*_ORDER, "when"), "amplitude without AFF and now"),
    Metric(
        "aff_order_ripple_meters_per_second",
        GAUGE,
        (*_ORDER, "when"),
        "the same where the error signal is a speed",
    ),
    Metric("aff_order_remaining_ratio", GAUGE, _ORDER, "ripple now over without; dB = 20 log10"),
    Metric("aff_order_share_ratio", GAUGE, _ORDER, "share of an order that the law lets out"),
    Metric("aff_order_response_ratio", GAUGE, _ORDER, "true response over the measured one"),
    Metric("aff_order_resting", GAUGE, (*_ORDER, "why"), "1 for an order that is held or rests"),
    Metric("aff_roll_deviation_meters", GAUGE, _ORDER, "how far a roll is from round"),
    Metric(
        "aff_roll_deviation_angle_radians",
        GAUGE,
        _ORDER,
        "where: the angle at which the encoder reads zero is 0",
    ),
    Metric("aff_correction_meters_per_second", GAUGE, ("actuator",), "correction sent"),
    Metric("aff_correction_newton_meters", GAUGE, ("actuator",), "correction sent"),
    Metric("aff_correction_limit_meters_per_second", GAUGE, ("actuator",), "largest correction"),
    Metric("aff_correction_limit_newton_meters", GAUGE, ("actuator",), "largest correction"),
    Metric("aff_correction_applied_ratio", GAUGE, ("actuator",), "share of the law's wish sent"),
    Metric("aff_correction_scaled_ratio", GAUGE, ("actuator",), "share left by the limits alone"),
    Metric("aff_next_order_meeting_seconds", GAUGE, ("actuator",), "until two orders meet"),
    Metric("aff_realtime_right_granted", GAUGE, ("right",), "1 for a right that is held"),
    Metric("aff_recorder_rows_total", COUNTER, (), "rows written since this recorder began"),
    Metric("aff_recorder_rows_lost_total", COUNTER, (), "rows that no file took"),
    Metric("aff_ring_overruns_total", COUNTER, ("reader",), "rows that a reader was too late for"),
    Metric("aff_recordings_bytes", GAUGE, (), "size of all runs when a segment last ended"),
    Metric("aff_recordings_limit_bytes", GAUGE, (), "what all runs together may take"),
    Metric("aff_disk_free_bytes", GAUGE, (), "left on the disk of the runs"),
    Metric("aff_control_restarts_total", COUNTER, (), "control processes that died and came back"),
    Metric("aff_audit_records_total", COUNTER, (), "number of the newest line of the audit"),
    Metric(
        "aff_audit_chain_ok",
        GAUGE,
        (),
        "1 while the chain of the audit holds and every line was written or is counted in it",
    ),
    Metric(
        "aff_commands_total",
        COUNTER,
        ("action", "via", "result"),
        "commands of console, screen and signal since the service began",
    ),
    Metric(
        "aff_probe_timestamp_seconds",
        GAUGE,
        ("actuator",),
        "when the response in force was measured, s since 1970",
    ),
    Metric(
        "aff_probe_coherence_lowest_ratio", GAUGE, ("actuator",), "lowest coherence of its points"
    ),
    Metric(
        "aff_probe_phase_error_highest_radians",
        GAUGE,
        ("actuator",),
        "largest bound of its phase error at a point",
    ),
    Metric("aff_watch_notes", GAUGE, (), "what aff-runtime watch says of rollers over weeks"),
    Metric("aff_watch_timestamp_seconds", GAUGE, (), "when it last looked, s since 1970"),
)
OF_SCREEN: tuple[Metric, ...] = (
    Metric("aff_tick_duration_seconds", HISTOGRAM, (), "whole tick, every tick"),
    Metric("aff_tick_wakeup_delay_seconds", HISTOGRAM, (), "how late a tick begins"),
    Metric("aff_tick_wire_duration_seconds", HISTOGRAM, (), "exchange with the PLC"),
    Metric("aff_plc_data_age_seconds", HISTOGRAM, (), "age of the PLC's data at every tick"),
    Metric(
        "aff_wire_exchanges_total", COUNTER, ("outcome",), "exchanges with the PLC, one a tick"
    ),
    Metric("aff_events_total", COUNTER, ("event",), "events of the control process"),
    Metric("aff_tension_ripple_rms_newtons", GAUGE, ("channel",), "all that moves in 10 s"),
    Metric("aff_roll_turns_total", COUNTER, ("roll",), "turns of a roll, either way"),
    Metric("aff_web_meters_total", COUNTER, ("roll",), "surface that a roll has turned by"),
    Metric(
        "aff_correction_peak_meters_per_second", GAUGE, ("actuator",), "largest correction of 10 s"
    ),
    Metric(
        "aff_correction_peak_newton_meters", GAUGE, ("actuator",), "largest correction of 10 s"
    ),
    Metric(
        "aff_correction_saturated_seconds_total",
        COUNTER,
        ("actuator",),
        "ACTIVE with a limit that takes something off the correction",
    ),
    Metric("aff_active_seconds_total", COUNTER, (), "the guard was ACTIVE"),
    Metric("aff_hmi_sockets", GAUGE, (), "browsers that look at this screen"),
    Metric("aff_hmi_frames_total", COUNTER, (), "frames that the screen has sent"),
    Metric("aff_hmi_frames_skipped_total", COUNTER, (), "frames that slow browsers did without"),
    Metric(
        "aff_hmi_certificate_seconds",
        GAUGE,
        (),
        "until the first certificate of this screen ends; negative: it has ended",
    ),
    Metric("aff_hmi_sessions", GAUGE, ("role",), "who has logged in"),
    Metric("aff_hmi_logins_total", COUNTER, ("result",), "logins: done, refused, told to wait"),
    Metric(
        "aff_hmi_presses_total",
        COUNTER,
        ("action", "result"),
        "bypass and arm: done, refused, or failed for want of a service",
    ),
    Metric("aff_hmi_frame_delay_seconds", HISTOGRAM, (), "from a tick to a browser's socket"),
    Metric("aff_hmi_http_requests_total", COUNTER, ("route", "code"), "answers to requests"),
    Metric("aff_hmi_http_duration_seconds", HISTOGRAM, (), "from a request to its answer"),
)
"""What the screen counts: of every tick that it sees, and of itself, since it was started."""

CATALOGUE = (*OF_SERVICE, *OF_SCREEN)
BY_NAME = {metric.name: metric for metric in CATALOGUE}
