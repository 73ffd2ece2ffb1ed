import asyncio
import csv
import gzip
from itertools import count

import pytest

from aff_runtime.base.errors import WireError
from aff_runtime.base.signals import StateBits
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block
from tests.sim_plant.servers.served import SAMPLE_TIME_s, ask, served, wait_until

pytestmark = pytest.mark.wire


def write(client, block):
    """Send the write block by FC16 and read the answer."""
    data = "".join(f"{word:04X}" for word in block)
    frame = f"0001 0000 001B 01 10 0064 000A 14 {data}"
    assert len(ask(client, frame, 12)) == 12


def test_the_plc_trips_on_the_wire_and_history_shows_the_ramp():
    with served() as plant, plant.client() as client:
        heartbeat = count(1)

        def drive():
            """Be READY until the PLC would accept, then ACTIVE; a late test starts again."""
            refusal = plant.command("status")["refusal"]
            state = StateBits.READY if refusal[:5] in {"watch", "rearm"} else StateBits.ACTIVE
            write(client, write_block(next(heartbeat), unwind=2000, state=state))
            return plant.command("status")["applied_m_s"]["unwind"] == 0.02

        wait_until(drive)
        wait_until(lambda: plant.command("status")["applied_m_s"]["unwind"] == 0.0)
        history = plant.command("history 10000")
        status = plant.command("status")
    applied = [row[0] for row in history["applied_m_s"]]
    last_full = max(k for k, value in enumerate(applied) if value == 0.02)
    ramp_scans = round(0.1 / SAMPLE_TIME_s)
    expected = [0.02 * (1 - k / ramp_scans) for k in range(ramp_scans + 1)]
    assert applied[last_full : last_full + ramp_scans + 1] == pytest.approx(expected, abs=1e-9)
    assert status["counts"]["watchdog_trips"] >= 1
    assert status["max_abs_applied_m_s"]["unwind"] == pytest.approx(0.02)
    assert status["aff"]["state_bits"] == ["ACTIVE"]


def test_the_record_has_one_row_per_sample(tmp_path):
    path = tmp_path / "run.csv.gz"
    with served(record=path) as plant:
        wait_until(lambda: plant.service.plant.scans > 20)
    with gzip.open(path, "rt", encoding="ascii") as stream:
        rows = list(csv.DictReader(stream))
    times = [float(row["time_s"]) for row in rows]
    assert len(rows) == plant.service.plant.scans - 1
    assert times == pytest.approx([SAMPLE_TIME_s * (k + 2) for k in range(len(rows))])
    assert float(rows[-1]["tension_ref_N"]) == 90.0
    assert rows[0].keys() >= {"true_unwind_tension_N", "applied_unwind_m_s"}


def test_a_taken_port_is_told_and_nothing_is_left_behind(tmp_path):
    control = tmp_path / "control"
    with served() as plant:
        options = ServeOptions(port=plant.port, realtime=False, control=control)

        async def second():
            await PlantService(FakeLine(), default_map(), options).run(print)

        with pytest.raises(WireError, match=f"cannot listen on 127.0.0.1:{plant.port}"):
            asyncio.run(second())
    assert not control.exists()


def test_a_duration_ends_the_service():
    said = []

    async def run():
        options = ServeOptions(port=0, realtime=False, duration_s=0.05)
        service = PlantService(FakeLine(0.01), default_map(), options)
        await asyncio.wait_for(service.run(said.append), 10.0)
        return service

    service = asyncio.run(run())
    assert said == [
        f"ready modbus 127.0.0.1:{service.server.port} sample_time_s 0.01 realtime not asked"
    ]
