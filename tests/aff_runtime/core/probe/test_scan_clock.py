"""When a sample was taken: a read at the edge of a scan shows the one before or behind."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest

from aff_runtime.core.probe.probe import Probe, Stage
from aff_runtime.core.probe.scan_clock import scan_time_s
from tests.aff_runtime.core.plants import (
    CYCLE_S,
    FREE,
    LagDelay,
    Line,
    site,
    snapshot,
    with_blocks,
)
from tests.aff_runtime.core.probe.noisy_line import BLOCKS, noise
from tests.aff_runtime.core.probe.test_probe import ORIGIN, PARAMS
from tests.each_case import each_case

READS = 4000


def read_of(scan_s, *, counts=2**16, seed=3, start=200):
    """Return the cycle's time, the heartbeat and the true time of every read that was new."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(READS) * CYCLE_S
    scans = np.floor((time_s + rng.normal(0.0, 3e-4, READS)) / scan_s + 0.5)
    new = np.diff(scans, prepend=-1.0) > 0.0
    return time_s[new], np.mod(scans[new] + start, counts), scans[new] * scan_s


@each_case("scan_s", [5.0005e-3, 1e-3, 4e-3, 20e-3])
@each_case("counts", [2**8, 2**16, 2**32, 10_000 * 2**8])
def test_reads_stand_at_the_scan_that_they_show(scan_s, counts):
    time_s, heartbeat, true_s = read_of(scan_s, counts=counts, start=counts - 300)
    found_s = scan_time_s(time_s, heartbeat)
    # but for a rate and an origin that both clocks share on average
    line = np.polyval(np.polyfit(true_s, found_s, 1), true_s)
    assert float(np.abs(found_s - line).max()) < 1e-9
    assert float(np.mean(found_s - time_s)) == pytest.approx(0.0, abs=1e-12)


def test_a_scan_that_takes_as_long_as_its_work_is_no_clock():
    rng = np.random.default_rng(1)
    ends_s = np.cumsum(rng.uniform(2e-3, 8e-3, 2 * READS))
    time_s = np.arange(READS) * CYCLE_S
    heartbeat = np.searchsorted(ends_s, time_s).astype(float)
    assert scan_time_s(time_s, heartbeat) is time_s


@pytest.mark.parametrize("stands_s", [0.0, 0.04])
def test_of_two_clocks_that_part_the_one_counts_on_which_the_rolls_turn_steadily(stands_s):
    """A PLC that stands now and then goes on from there; on its own clock its roll is steady."""
    rng = np.random.default_rng(2)
    time_s = np.arange(READS) * CYCLE_S
    stood_s = stands_s * np.cumsum(rng.random(READS) < 0.01)
    scans = np.maximum.accumulate(np.floor((time_s - stood_s) / CYCLE_S + 0.5))
    work = np.searchsorted(np.cumsum(rng.uniform(2e-3, 8e-3, READS)), time_s).astype(float)
    for count, turned_s, is_clock in ((scans, scans * CYCLE_S, True), (work, time_s, False)):
        new = np.diff(count, prepend=-1.0) > 0.0
        angle_rad = 5.0 * turned_s + rng.normal(0.0, 1e-3, READS)
        read_s = time_s[new]
        found_s = scan_time_s(read_s, count[new], [angle_rad[new]])
        assert (found_s is not read_s) is is_clock


@pytest.mark.parametrize(
    "heartbeat",
    [
        np.full(READS, 7.0),
        np.full(READS, np.nan),
        -np.arange(0.0, READS),
        np.r_[np.arange(0.0, READS // 2), np.arange(READS // 2) * 5 % 256],
        np.mod(np.arange(35.0 - READS, 35.0), 10_000),
    ],
    ids=["stands", "absent", "counts down", "jumps", "starts over at 10000, near the end"],
)
def test_what_is_no_count_of_scans_moves_nothing(heartbeat):
    time_s = np.arange(READS) * CYCLE_S
    np.testing.assert_array_equal(scan_time_s(time_s, heartbeat), time_s)


def error_of_a_tone(*, counts_scans: bool) -> float:
    """Return the median error of a probe that reads at the edge of a scan.

    A roll that the site file does not know shakes the tension: half a scan is a twelfth of a
    radian of it.
    """
    rng = random.Random(4)
    rolls = site(with_blocks(BLOCKS))
    rolls = replace(rolls, rolls=rolls.rolls[:1])
    probe = Probe(rolls, PARAMS)
    line = Line(LagDelay(-400.0), {("swrap", 5): 20.0}, seed_noise=noise(0.05))
    before, shown = line.read(), -1
    for _ in range(round(32.0 / CYCLE_S)):
        now = line.read()
        scan = line.tick - (rng.random() < 0.5)
        seen = snapshot(line.tick, *(now if scan == line.tick else before), fresh=scan != shown)
        heartbeat = scan if counts_scans else line.tick
        (step,) = probe.step(replace(seen, plc_heartbeat=heartbeat), CYCLE_S, FREE)
        before, shown = now, scan
        line.advance(step.value)
    assert probe.stage is Stage.DONE
    (result,) = probe.result(ORIGIN)
    return float(np.median([p.relative_error for p in result.response.points]))


def test_a_probe_hears_better_by_the_clock_of_the_plc():
    # one read of four shows nothing new: enough is left
    assert error_of_a_tone(counts_scans=True) < 0.5 * error_of_a_tone(counts_scans=False)
