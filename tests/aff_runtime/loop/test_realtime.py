"""Rights are asked for in a process of their own, so that the tests keep theirs."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

from aff_runtime.loop.realtime import Grant, RealtimeReport, RealtimeRequest, ask

SCRIPT = """
import gc, json, os, sys
from dataclasses import asdict
from aff_runtime.loop.realtime import RealtimeRequest, ask
if {drop} and os.getuid() == 0:
    os.setgroups([])
    os.setgid(65534)
    os.setuid(65534)
report = ask(RealtimeRequest(cpus={cpus}))
print(json.dumps(dict(
    grants={{g.name: (g.granted, g.reason) for g in report.grants}},
    fd=report.latency_fd,
    policy=os.sched_getscheduler(0),
    priority=os.sched_getparam(0).sched_priority,
    affinity=sorted(os.sched_getaffinity(0)),
    collecting=gc.isenabled(),
    frozen=gc.get_freeze_count(),
)))
"""


def ask_in_child(*, drop: bool, cpus: tuple[int, ...]) -> dict[str, Any]:
    script = SCRIPT.format(drop=drop, cpus=cpus)
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=30, check=True
    )
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_without_privileges_refusals_carry_a_reason_and_nothing_fails() -> None:
    answer = ask_in_child(drop=True, cpus=(4096,))
    for name in ("SCHED_FIFO 80", "on processor 4096"):
        granted, reason = answer["grants"][name]
        assert not granted
        assert reason
    assert answer["policy"] == 0
    assert answer["grants"]["garbage collector off"] == [True, ""]
    assert answer["grants"]["timer slack 1 ns"] == [True, ""]
    assert not answer["collecting"]
    assert answer["frozen"] > 0


def test_what_is_reported_as_granted_is_really_in_force() -> None:
    answer = ask_in_child(drop=False, cpus=(0,))
    grants = answer["grants"]
    assert len(grants) == 6
    if grants["SCHED_FIFO 80"][0]:
        assert answer["priority"] == 80
    if grants["on processor 0"][0]:
        assert answer["affinity"] == [0]
    assert (answer["fd"] >= 0) == grants["/dev/cpu_dma_latency held at 0"][0]


def test_nothing_asked_for_is_nothing_reported() -> None:
    request = RealtimeRequest(
        fifo_priority=0,
        lock_memory=False,
        shallow_sleep=False,
        quiet_collector=False,
        timer_slack_ns=0,
    )
    assert ask(request) == RealtimeReport(grants=())


@pytest.mark.parametrize(
    ("grant", "line"),
    [
        (Grant(name="memory locked", granted=True), "memory locked: granted"),
        (Grant(name="memory locked", granted=False, reason="no"), "memory locked: refused, no"),
    ],
)
def test_the_report_reads_as_sentences(grant: Grant, line: str) -> None:
    assert RealtimeReport(grants=(grant,)).lines() == (line,)
