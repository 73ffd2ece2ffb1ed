"""Ticks on the edge of the PLC's scan, in the whole loop: there every fourth reading is old."""

from __future__ import annotations

import random

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.ports import Gateway
from aff_runtime.base.signals import Outcome
from aff_runtime.config.models.site import Site
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from aff_runtime.fieldbus.scan_edge import ScanEdge
from aff_runtime.loop.record import HEAD
from tests.lockstep.bench import Bench, Setup, Transport
from tests.lockstep.known_response import ROOT
from tests.lockstep.silent import watched

JITTER_NS = 200_000  # by which a request reaches the PLC late, at most
FRESH = HEAD.index("fresh")


class LateTransport(Transport):
    """Requests reach the PLC up to ``JITTER_NS`` after their tick."""

    def transact(self, write_words: list[int], deadline_ns: int) -> tuple[Outcome, list[int]]:
        self._clock.advance_ns(DICE.randint(0, JITTER_NS))
        return super().transact(write_words, deadline_ns)


DICE = random.Random(3)


class EdgeBench(Bench):
    """A bench whose grid lies half the jitter before the scan's edge."""

    leaves = False

    def _gateway(self, site: Site, setup: Setup) -> Gateway:
        self._transport = LateTransport(self.clock, self.wire)
        self.clock.advance_ns(self.period_ns - JITTER_NS // 2)  # the scan's origin is behind
        edge = ScanEdge(self.period_ns, WordGateway.heartbeat_modulus) if self.leaves else None
        words = WordCodec(setup.words or register_map(site))
        return WordGateway(self._transport, words, self.clock, edge=edge)


class LeavingBench(EdgeBench):
    leaves = True


def fresh_share(bench: Bench, seconds: float) -> float:
    seen: list[float] = []
    bench.outside.watchers.append(lambda row: seen.append(row[FRESH]))
    bench.run(seconds)
    return float(np.mean(seen))


def test_the_cycle_leaves_the_edge_and_sees_every_scan_from_then_on():
    left, stayed = LeavingBench(Setup()), EdgeBench(Setup())
    for bench in (left, stayed):
        bench.run(2.0)
    assert fresh_share(stayed, 1.0) == pytest.approx(0.75, abs=0.1)  # of two coins that differ
    assert fresh_share(left, 1.0) == 1.0


@pytest.mark.long
def test_the_ripple_at_the_edge_is_that_of_a_grid_beside_it(responses):
    left_N = []
    for make in (Bench, LeavingBench, EdgeBench):
        bench = make(Setup(site=ROOT / "config" / "euclid.yaml", responses=responses))
        bench.run(2.0)
        bench.arm(20.0)
        rows = watched(bench)
        bench.run(10.0)
        left_N.append(float(np.std(np.array(rows)[:, 0])))
    beside, leaving, staying = left_N
    assert leaving < 1.2 * beside
    assert staying > 1.5 * beside
