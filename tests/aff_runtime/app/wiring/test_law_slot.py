"""The law around controller and probe: short gaps of permission, columns that stay."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.app.check.validate import check_result
from aff_runtime.app.wiring.assemble import controller_of
from aff_runtime.app.wiring.law_slot import BRIDGED_S, LawSlot
from aff_runtime.app.wiring.site_to_law import probe_params, site_params
from aff_runtime.base.signals import Outcome, Permission, Snapshot
from aff_runtime.core.probe.probe import Probe, Stage

SITE = Path(__file__).parents[4] / "config" / "euclid_blocks.yaml"
DT_S = 0.005


def snapshot(tick: int) -> Snapshot:
    """A line at 1 m/s with 0.9 turns per second of both rolls."""
    angle = 6.2831853 * 0.9 * tick * DT_S
    return Snapshot(
        tick=tick,
        t_ns=tick * 5_000_000,
        outcome=Outcome.OK,
        fresh=True,
        age_s=0.0,
        plc_heartbeat=tick,
        status=0,
        roll_id=1,
        values=(90.0, 90.0, 1.0, 0.16, 1.0, 90.0, angle, angle),
    )


def permission(adapt: bool) -> Permission:
    return Permission(adapt=adapt, applied_ratio=(1.0, 1.0), limit_ratio=(1.0, 1.0))


def probing() -> tuple[LawSlot, Probe]:
    parameters = check_result(SITE).parameters
    assert parameters is not None
    site = parameters.site
    probe = Probe(site_params(site), probe_params(site, ["unwind"]))
    law = LawSlot(controller_of(site, parameters.responses, parameters.loops), probe=probe)
    tick = 0
    while probe.stage is not Stage.EXCITING:
        tick += 1
        law.step(snapshot(tick), DT_S, permission(True))
        assert tick < 5000
    for _ in range(400):
        tick += 1
        law.step(snapshot(tick), DT_S, permission(True))
    return law, probe


def test_a_probe_lives_through_a_gap_that_is_shorter_than_the_bridge() -> None:
    law, probe = probing()
    for k in range(round(BRIDGED_S / DT_S) - 1):
        law.step(snapshot(10_000 + k), DT_S, permission(False))
    law.step(snapshot(20_000), DT_S, permission(True))
    assert probe.stage is Stage.EXCITING


def test_a_probe_ends_when_permission_stays_away() -> None:
    law, probe = probing()
    for k in range(round(BRIDGED_S / DT_S) + 2):
        law.step(snapshot(10_000 + k), DT_S, permission(False))
    assert probe.stage is Stage.ABORTED


def test_columns_are_the_same_with_and_without_a_probe() -> None:
    law, _ = probing()
    assert LawSlot(law.controller).law_telemetry_names() == law.law_telemetry_names()
    assert len(law.law_telemetry()) == len(law.law_telemetry_names())
