"""The one place where rooms meet: from a parameter record to everything the cycle needs.

site file ─validate→ record ─┬→ register map → codec ┐
                             │      transport ───────┴→ gateway ┐
                             ├→ angles, blocks, responses → law ┼→ cycle
                             └→ limits, permissives → guard ────┘
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.app.wiring.loops import loops_of
from aff_runtime.app.wiring.recorded_law import RecordedLaw
from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.app.wiring.wires import gateway_of
from aff_runtime.base.ports import Clock, Gateway
from aff_runtime.config.models import Site
from aff_runtime.core.controller import Controller
from aff_runtime.core.response import Response
from aff_runtime.loop.cycle import Cycle, CycleSettings
from aff_runtime.loop.seams import Outside
from aff_runtime.safety.guard import Guard


@dataclass(frozen=True, slots=True, kw_only=True)
class Assembly:
    """The rooms, wired but for the outside."""

    record: Mapping[str, Any]
    site: Site
    clock: Clock
    gateway: Gateway
    guard: Guard
    law: RecordedLaw


def assemble(record: Mapping[str, Any], clock: Clock) -> Assembly:
    """Return the rooms of one site.

    Raises
    ------
    AffError
        When the record cannot be used or the PLC's name cannot be resolved.
    """
    site = site_of(record)
    gateway = gateway_of(
        site, record.get("wire_files", {}), clock, Path(record.get("folder", "."))
    )
    guard = Guard(guard_params(site))
    law = RecordedLaw(controller_of(site, record))
    return Assembly(record=record, site=site, clock=clock, gateway=gateway, guard=guard, law=law)


def cycle_of(assembly: Assembly, outside: Outside) -> Cycle:
    """Return the cycle over the wired rooms."""
    site = assembly.site
    settings = CycleSettings(
        period_ns=round(site.cycle_s * 1e9),
        io_deadline_ns=round(site.gateway.deadline_ms * 1e6),
        fade_s=site.freshness.fade_ms * 1e-3,
        channel_count=len(site.gateway.read.channels),
        output_count=len(site.actuators),
        law_columns=0,
        command_life_s=site.freshness.fault_after_ms * 1e-3,
        config_revision=revision_of(assembly.record),
        first_heartbeat=secrets.randbelow(1 << 16),  # two that start at once must be told apart
    )
    return Cycle(
        settings=settings,
        clock=assembly.clock,
        gateway=assembly.gateway,
        guard=assembly.guard,
        law=assembly.law,
        outside=outside,
    )


def site_of(record: Mapping[str, Any]) -> Site:
    """Return the site of a parameter record."""
    return Site.model_validate(record["site"])


def controller_of(site: Site, record: Mapping[str, Any]) -> Controller:
    """Return the law of a site with its measured responses and what was made of them."""
    measured = {name: Response.from_json(text) for name, text in record["responses"].items()}
    return Controller(site_params(site), measured, loops_of(record))


def revision_of(record: Mapping[str, Any]) -> int:
    """Return the low 16 bits of the configuration's hash, as the PLC shows it."""
    return int(str(record["config_hash"])[-4:], 16)
