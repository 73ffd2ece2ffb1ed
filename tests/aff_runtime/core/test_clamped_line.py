"""A block that is not given what it needs must not drive the line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.wiring.site_to_law import site_params
from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.ports import Law
from aff_runtime.base.signals import Command, Permission, StateBits
from aff_runtime.config.loader import load_site
from aff_runtime.core.controller import Controller
from aff_runtime.core.params import ProbeParams, SiteParams
from aff_runtime.core.probe.probe import Probe
from aff_runtime.core.response import Provenance
from aff_runtime.fieldbus.modbus.codec import WordCodec
from aff_runtime.fieldbus.modbus.gateway import WordGateway
from sim_plant.line import open_line
from sim_plant.servers.map_file import load_plc_map
from sim_plant.servers.plc import Plc
from tests.doubles.lockstep_plant import LockstepPlant
from tests.doubles.virtual_clock import VirtualClock

CONFIG = Path(__file__).parents[3] / "config"
CYCLE_S = 0.005
NEEDED_M_S = 0.012
GIVEN_M_S = 0.008
FOLLOWER = "swrap_follower"
WHOLE = Permission(adapt=True, applied_ratio=(1.0, 1.0), limit_ratio=(1.0, 1.0))


class Rig:
    """The follower's law and the whole line, through words, in virtual time."""

    def __init__(self) -> None:
        site = load_site(CONFIG / "euclid_blocks.yaml")
        self.site = _only_follower(site_params(site))
        line = open_line(CONFIG / "lines" / "euclid_ripple.yaml", seed=7)
        self.plant = LockstepPlant(line, Plc(load_plc_map(CONFIG / "plc" / "gateway_block.yaml")))
        self.clock = VirtualClock()
        self.gateway = WordGateway(self.plant, WordCodec(register_map(site)), self.clock)
        self.tick = 0
        self.echo = 0
        self.state = StateBits.READY
        self.corrections = (0.0, 0.0)

    def run(self, law: Law, seconds: float, *, sends: bool = True) -> np.ndarray:
        """Return pull-roll tension, N, and what went to the follower, m/s, per cycle."""
        self.state = StateBits.ACTIVE if sends else StateBits.READY
        rows = []
        for _ in range(round(seconds / CYCLE_S)):
            self.plant.advance(CYCLE_S)
            self.clock.advance_ns(5_000_000)
            self.tick += 1
            snapshot = self.gateway.exchange(self._command(), self.tick, self.clock.now_ns() + 1)
            self.echo = snapshot.plc_heartbeat
            (step,) = law.step(snapshot, CYCLE_S, WHOLE)[-1:]
            self.corrections = (0.0, step.value if sends else 0.0)
            rows.append(
                (self.plant.plant.measured["true_pullroll_tension_N"], self.corrections[1])
            )
        return np.array(rows)

    def _command(self) -> Command:
        return Command(
            heartbeat=self.tick & 0xFFFF,
            state_bits=int(self.state),
            echo=self.echo,
            corrections=self.corrections,
            alarm=0,
            limits=(0.05, 0.02),
            config_revision=1,
        )


def _only_follower(site: SiteParams) -> SiteParams:
    actuators = []
    for actuator in site.actuators:
        blocks = [replace(block, amp_limit=GIVEN_M_S) for block in actuator.blocks]
        mine = blocks if actuator.name == FOLLOWER else []
        actuators.append(replace(actuator, blocks=tuple(mine)))
    return replace(site, actuators=tuple(actuators))


@pytest.mark.long
def test_a_clamped_block_reduces_the_ripple_it_can_and_never_adds_to_it() -> None:
    rig = Rig()
    rig.run(Controller(rig.site, {}), 2.0, sends=False)
    alone = rig.run(Controller(rig.site, {}), 15.0, sends=False)[:, 0].std()
    params = ProbeParams(
        actuators=(FOLLOWER,),
        amplitude=0.004,
        max_speed_m_s=1.53,
        f_max_Hz=10.0,
        louder_from_Hz=3.0,
    )
    probe = Probe(rig.site, params)
    rig.run(probe, 29.0)
    (result,) = probe.result({FOLLOWER: Provenance(actuator=FOLLOWER, signal="tension")})
    law = Controller(rig.site, {FOLLOWER: result.response})
    rows = rig.run(law, 60.0)
    every_10_s = rows[:, 0].reshape(6, -1).std(axis=1)
    sent_m_s = np.abs(rows[:, 1])
    assert NEEDED_M_S > sent_m_s.max() > 0.99 * GIVEN_M_S
    assert np.all(every_10_s[1:] < alone), every_10_s
    assert np.ptp(every_10_s[2:]) < 0.1 * alone, every_10_s  # no slow swing builds up
