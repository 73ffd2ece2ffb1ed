"""The one place where rooms meet: from a parameter record to everything the cycle needs.

site file ─validate→ record ─┬→ register map → codec ┐
                             │      transport ───────┴→ gateway ┐
                             ├→ angles, blocks, responses → law ┼→ cycle
                             └→ limits, permissives → guard ────┘
"""

from __future__ import annotations

import math
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring.impulse_responses import impulse_responses
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_law import NO_RANGES, site_params
from aff_runtime.app.wiring.wires import gateway_of
from aff_runtime.base.ports import Clock, Gateway
from aff_runtime.config.models import Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.response import Response
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.ports import OutsidePort
from aff_runtime.safety.guard import Guard

ADVICE_S = 0.1  # between two looks of `LawWatch` at the law
LEAST_OVERRUNS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Assembly:
    """The rooms, wired but for the outside."""

    parameters: ParameterRecord
    site: Site
    clock: Clock
    gateway: Gateway
    guard: Guard
    law: LawSlot


def assemble(parameters: ParameterRecord, clock: Clock) -> Assembly:
    """Return the rooms of one site.

    Raises
    ------
    AffError
        When the record cannot be used or the PLC's name cannot be resolved.
    """
    site = parameters.site
    gateway = gateway_of(site, parameters.wire_files, clock, parameters.folder)
    guard = Guard(guard_params(site))
    law = LawSlot(controller_of_record(parameters))
    return Assembly(
        parameters=parameters, site=site, clock=clock, gateway=gateway, guard=guard, law=law
    )


def cycle_of(assembly: Assembly, outside: OutsidePort) -> Cycle:
    """Return the cycle over the wired rooms."""
    site = assembly.site
    settings = CycleSettings(
        period_ns=round(site.cycle_s * 1e9),
        io_budget_ns=round(site.gateway.deadline_ms * 1e6),
        fade_s=site.freshness.fade_ms * 1e-3,
        channel_count=len(site.gateway.read.channels),
        output_count=len(site.actuators),
        law_columns=0,
        overruns_in_a_row=overruns_in_a_row(site),
        advice_every_ticks=max(1, round(ADVICE_S / site.cycle_s)),
        command_life_s=site.freshness.fault_after_ms * 1e-3,
        config_revision=assembly.parameters.revision_word,
        first_heartbeat=secrets.randbelow(1 << 16),  # tells apart two that start at once
    )
    return Cycle(
        settings=settings,
        clock=assembly.clock,
        gateway=assembly.gateway,
        guard=assembly.guard,
        law=assembly.law,
        outside=outside,
    )


def overruns_in_a_row(site: Site) -> int:
    """Return how many late ticks in a row are an overrun: ``hold_after_ms``, 3 at least."""
    return max(LEAST_OVERRUNS, math.ceil(site.freshness.hold_after_ms / site.line.cycle_ms))


def controller_of_record(parameters: ParameterRecord) -> Controller:
    """Return the law of a parameter record."""
    return controller_of(
        parameters.site, parameters.responses, parameters.loops, parameters.counter_ranges_rad
    )


def controller_of(
    site: Site,
    responses: Mapping[str, str],
    taps: Mapping[str, Sequence[float]],
    counter_ranges_rad: Mapping[str, float] = NO_RANGES,
) -> Controller:
    """Return the law of a site with its measured responses and what was made of them.

    Parameters
    ----------
    responses : text of the measured response by actuator.
    taps : of the impulse response by actuator, as `taps_by_actuator` returns them.
    counter_ranges_rad : as of `site_params`.
    """
    measured = {name: Response.from_json(text) for name, text in responses.items()}
    params = site_params(site, counter_ranges_rad)
    return Controller(params, measured, impulse_responses(taps))
