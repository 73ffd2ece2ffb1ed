"""What the gateway itself needs: room for records, a clock, a certificate, an audit that holds."""

from __future__ import annotations

from collections.abc import Iterator

from aff_hmi.condition import LASTS_S, RANK, TIMING, Condition
from aff_hmi.watch import Observed
from aff_hmi.words import N_
from aff_runtime.app.report.alarm_table import Priority
from aff_runtime.telemetry.recorder_messages import NOT_SAID, RecorderReport

LEAST_FREE = 0.05  # of the disk: what logs and updates of the machine itself need
SOON_DAYS = 30.0  # of a certificate: time to get another one in a plant
DAY_S = 86_400.0


def upkeep(seen: Observed) -> Iterator[Condition]:
    """Yield what stands of it."""
    facts = seen.facts
    if facts is not None:
        yield from _audit(facts.status.audit_ok)
        yield from _disk(facts.status.recorder)
    if seen.clock_step_s:
        yield Condition(
            key="CLOCK",
            rank=RANK[Priority.LOW],
            name="CLOCK",
            text=N_(
                "the gateway's clock was set by {seconds} s: times of records and events before "
                "and after it do not go together"
            ),
            values={"seconds": f"{seen.clock_step_s:+.1f}"},
            to_do=N_("look at its time server: chronyc tracking, or timedatectl"),
        )
    if seen.certificate_s is not None and seen.certificate_s < SOON_DAYS * DAY_S:
        yield _certificate(seen.certificate_s)


def _audit(audit_ok: int) -> Iterator[Condition]:
    if audit_ok == 0:
        yield Condition(
            key="AUDIT",
            rank=RANK[Priority.HIGH],
            name="AUDIT",
            text=N_("the audit of commands is broken or cannot be written: no screen arms"),
            to_do=N_("copy it first; then, on the gateway: aff-runtime audit verify"),
        )


def _disk(recorder: RecorderReport | None) -> Iterator[Condition]:
    """Yield it where records will be lost, or little is left whoever fills it."""
    if recorder is None or recorder.free_bytes == NOT_SAID:
        return
    free = recorder.free_bytes
    is_known = NOT_SAID not in (recorder.kept_bytes, recorder.max_bytes)
    to_come = recorder.max_bytes - recorder.kept_bytes if is_known else 0
    is_little = free < LEAST_FREE * recorder.disk_bytes  # never, of a disk whose size is not said
    if free < to_come or is_little:
        yield Condition(
            key="DISK",
            rank=RANK[Priority.LOW],
            name="DISK",
            text=N_("{free} MB are left on the disk of the records, which may grow by {more} MB"),
            values={"free": f"{free / 1e6:.0f}", "more": f"{max(0, to_come) / 1e6:.0f}"},
            to_do=N_("delete what is not needed there, or lower record.max_MB"),
            delay_s=LASTS_S,
            page=TIMING,
        )


def _certificate(left_s: float) -> Condition:
    text, days = N_("the certificate of this screen ends in {days} days"), int(left_s // DAY_S)
    if left_s <= 0.0:
        text = N_("the certificate of this screen has ended: browsers refuse it")
    return Condition(
        key="CERTIFICATE",
        rank=RANK[Priority.LOW],
        name="CERTIFICATE",
        text=text,
        values={"days": str(max(0, days))},
        to_do=N_("put another one in its place and restart aff-hmi"),
    )
