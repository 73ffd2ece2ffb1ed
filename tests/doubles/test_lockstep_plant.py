import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Outcome, StateBits, Status
from sim_plant.servers.faults import Fault, FaultBoard, parse_fault
from sim_plant.servers.plc import Plc
from tests.doubles.lockstep_plant import LockstepPlant
from tests.sim_plant.servers.fake_line import FakeLine, N_PER_m_s, default_map, write_block

TICK_s = 0.005


class Runtime:
    """A runtime that wants a constant correction whatever it reads."""

    def __init__(self, *faults):
        board = FaultBoard(tuple(parse_fault(text) for text in faults))
        self.wire = LockstepPlant(FakeLine(), Plc(default_map()), faults=board)
        self.heartbeat = 0

    def run(self, ticks, **words):
        for _ in range(ticks):
            self.heartbeat += 1
            outcome, read = self.wire.transact(write_block(self.heartbeat, **words), 0)
            self.wire.advance(TICK_s)
        return outcome, read

    def armed(self):
        self.run(3, state=StateBits.READY)
        return self

    def applied_m_s(self):
        return self.wire.plant.applied_m_s["unwind"]


def test_another_master_that_comes_last_is_idle_intact_and_in_the_echo():
    runtime = Runtime().armed()
    runtime.run(3, unwind=1000)
    assert runtime.applied_m_s() == pytest.approx(0.01)
    runtime.wire.inject(parse_fault("last:0.05"))
    _, read = runtime.run(5, unwind=1000)
    plant = runtime.wire.plant
    assert plant.refusal.startswith("state")
    assert plant.plc._says_zero(plant.registers.write_words)
    at = plant.plc.map.read["aff_echo"] - plant.plc.map.read_start
    echoes = [runtime.run(1, unwind=1000)[1][at] for _ in range(3)]
    assert echoes == [(read[at] + k) & 0xFFFF for k in (1, 2, 3)]
    assert (echoes[0] - runtime.heartbeat) & 0xFFFF > 1000
    assert runtime.applied_m_s() == 0.0


def test_the_correction_reaches_the_line():
    steady, corrected = Runtime().armed(), Runtime().armed()
    steady.run(300)
    corrected.run(300, unwind=1000)
    tension_N = corrected.wire.plant.measured["true_unwind_tension_N"]
    expected_N = steady.wire.plant.measured["true_unwind_tension_N"] - 0.01 * N_PER_m_s
    assert tension_N == pytest.approx(expected_N, abs=1e-3)


def test_the_words_read_are_those_of_the_last_scan():
    runtime = Runtime()
    _, words = runtime.wire.transact(write_block(1), 0)
    assert (words[0], words[8], words[4]) == (1, 1, 9000)
    runtime.wire.advance(3 * TICK_s)
    assert runtime.wire.transact(write_block(2), 0)[1][0] == 4


def test_fractions_of_a_sample_add_up():
    wire = Runtime().wire
    for _ in range(10):
        wire.advance(0.4 * TICK_s)
    assert wire.plant.scans == 1 + 4


@pytest.mark.parametrize(
    ("fault", "outcome"),
    [
        ("mute@0.5", Outcome.TIMEOUT),
        ("busy@0.5", Outcome.EXCEPTION),
        ("refuse@0.5", Outcome.NOT_CONNECTED),
        ("restart@0.5:9", Outcome.NOT_CONNECTED),
    ],
)
def test_a_lost_wire_is_zero_at_the_plant_within_300_ms(fault, outcome):
    runtime = Runtime(fault).armed()
    runtime.run(95, unwind=2000)
    assert runtime.applied_m_s() == pytest.approx(0.02)
    assert runtime.run(61, unwind=2000)[0] is outcome  # from 0.5 s to 0.8 s
    assert runtime.applied_m_s() == 0.0
    assert runtime.wire.transact(write_block(0), 0)[0] is outcome


@pytest.mark.parametrize(
    ("fault", "outcome"),
    [
        ("delay=9", Outcome.TIMEOUT),
        ("partial", Outcome.TIMEOUT),
        ("tid", Outcome.BAD_REPLY),
        ("short", Outcome.BAD_REPLY),
    ],
)
def test_a_useless_answer_does_not_undo_the_write(fault, outcome):
    runtime = Runtime(f"{fault}@0.1").armed()
    assert runtime.run(50, unwind=2000)[0] is outcome
    assert runtime.applied_m_s() == pytest.approx(0.02)


def test_after_a_restart_the_plc_counts_from_zero_and_wants_a_rearm():
    runtime = Runtime("restart@0.5:0.5").armed()
    runtime.run(240, unwind=1000)
    outcome, words = runtime.run(1, unwind=1000)
    assert outcome is Outcome.OK
    assert words[0] < 60
    assert runtime.applied_m_s() == 0.0
    assert runtime.wire.plant.refusal.startswith("rearm")
    runtime.armed().run(1, unwind=1000)
    assert runtime.applied_m_s() == pytest.approx(0.01)


def test_frozen_words_keep_their_heartbeat_while_writes_still_land():
    runtime = Runtime("freeze@0.1:0.2").armed()
    _, first = runtime.run(22, unwind=1000)
    _, later = runtime.run(20, unwind=500)
    assert later == first
    assert runtime.applied_m_s() == pytest.approx(0.005)
    _, thawed = runtime.run(25)
    assert thawed[0] == runtime.wire.plant.scans - 1


def test_swapped_words_are_the_other_order():
    runtime = Runtime("swap@0.05:0.1")
    _, swapped = runtime.run(15)
    runtime.wire.plant.faults.clear()
    tension_mN = (swapped[3] << 16) | swapped[2]
    assert 80_000 < tension_mN < 100_000


def test_nan_absurd_and_stuck_strike_tension_in_the_words():
    _, nan = Runtime("nan=unwind_tension_N@0.02").run(10)
    assert (nan[2], nan[3]) == (0x8000, 0)
    assert (nan[9], nan[10]) == (0x0001, 0x7318)  # 95.000 N
    _, absurd = Runtime("absurd@0.02").run(10)
    assert (absurd[2] << 16 | absurd[3]) == 1_000_000_000
    stuck = Runtime("stuck@0.02")
    _, before = stuck.run(10)
    _, after = stuck.run(50)
    assert before[2:4] == after[2:4]
    assert before[11:13] != after[11:13]


@pytest.mark.parametrize("other", ["stuck=unwind_tension_N", "absurd", "nan"])
def test_a_reading_that_sticks_anew_is_the_true_one_of_that_moment(other):
    runtime = Runtime()
    runtime.run(3)
    plant = runtime.wire.plant
    plant.inject(parse_fault(other))
    runtime.run(20)
    plant.clear(Fault.ABSURD)
    plant.clear(Fault.NAN)
    true_N = plant.measured["true_unwind_tension_N"]
    plant.inject(parse_fault("stuck=unwind_tension_N"))
    runtime.run(3)
    assert plant.measured["unwind_tension_N"] == true_N
    assert plant.measured["true_unwind_tension_N"] != true_N


def test_a_splice_is_counted_and_shown():
    runtime = Runtime("splice@0.1:0.1")
    _, during = runtime.run(25)
    _, after = runtime.run(25)
    assert (during[8], bool(during[1] & Status.SPLICE_ACTIVE)) == (2, True)
    assert (after[8], bool(after[1] & Status.SPLICE_ACTIVE)) == (2, False)


def test_a_dropped_permissive_comes_back_only_if_it_was_there():
    runtime = Runtime("permissive=WEB_INTACT@0.1:0.1", "permissive=RESET_EDGE@0.3:0.1")
    _, during = runtime.run(25)
    assert not during[1] & Status.WEB_INTACT
    _, after = runtime.run(60)
    assert after[1] & Status.WEB_INTACT
    assert not after[1] & Status.RESET_EDGE


def test_a_line_that_lacks_a_mapped_channel_is_refused_by_name():
    line = FakeLine()
    measured = dict(line.step({}))
    del measured["unwind_radius_m"]
    line.step = lambda inputs: measured
    with pytest.raises(PlantError, match="unwind_radius_m"):
        LockstepPlant(line, Plc(default_map()))


def test_history_and_extremes_tell_what_was_applied():
    runtime = Runtime().armed()
    runtime.run(5, unwind=-3000)
    runtime.run(5, unwind=100)
    plant = runtime.wire.plant
    assert [applied[0] for _, applied in plant.history(6)] == pytest.approx([-0.03] + [0.001] * 5)
    assert plant.max_abs_applied_m_s["unwind"] == pytest.approx(0.03)
    plant.reset_extremes()
    assert plant.max_abs_applied_m_s["unwind"] == 0.0


def test_references_reach_the_line_and_nonsense_does_not():
    plant = Runtime().wire.plant
    plant.set_reference("line_speed_ref_m_s", 0.5)
    plant.step()
    assert plant.measured["line_speed_m_s"] == 0.5
    for name, value in [("line_speed_ref_m_s", float("nan")), ("aff_unwind_m_s", 1.0)]:
        with pytest.raises(PlantError, match="references are"):
            plant.set_reference(name, value)
