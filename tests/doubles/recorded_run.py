"""Run folders as the service makes them, in virtual time: plant, PLC, runtime and recorder."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from aff_runtime.config.loader import load_site
from aff_runtime.loop.record import record_columns
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests import quick_yaml
from tests.aff_runtime.telemetry.heads import head_of
from tests.lockstep.bench import SEED, Bench, Setup
from tests.lockstep.can_bench import CanBench
from tests.lockstep.known_response import ROOT, known_responses

LINE_FILE = ROOT / "config/lines/euclid.yaml"
SITE_FILE = ROOT / "config/euclid_blocks.yaml"
PLC_FILE = ROOT / "config/plc/gateway_block.yaml"
SPEED_REF = "line_speed_ref_m_s"
UTC = "2026-01-02T03:04:05.000+00:00"
WORDS_FOR_RECORD = (
    ("unwind_supplier_number", 30, "u16", 1),
    ("unwind_torque_N_m", 31, "i32", 0.001),
)
IDLER = {"effect": "eccentric_roller", "location": "R6"}
FOLLOWER = {
    "effect": "eccentric_roller",
    "location": "swrap_follower",
    "parameters": {"eccentricity_m": 1.5e-4, "angle_rad": 0.5},
}
TRUTH = ("true_pullroll_tension_N", "true_swrap_follower_angle_rad")


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """What a service and a plant are started with."""

    line: Path
    site: Path
    plc_map: Path


def files(
    folder: Path,
    effects: Sequence[Mapping[str, Any]] = (),
    *,
    reference: bool = True,
    echo: bool = True,
    applied: bool = True,
    cancels: str = "r6",
    site_file: Path = SITE_FILE,
    cycle_ms: int = 5,
    for_record: bool = False,
) -> Files:
    """Write line, site and PLC files of the Euclid line and return them.

    Parameters
    ----------
    effects : that the plant has.
    reference : the PLC shows the speed reference and the site file maps it.
    echo, applied : the PLC shows these words, and the site file maps them (applied needs echo).
    cancels : idler that the unwind's correction has a block for; empty: the shipped blocks.
    site_file : of the shipped ones, the one to begin with.
    for_record : the PLC shows supplier and torque of the unwind, and the site file maps them.
    cycle_ms : of line, PLC and service; at 10 ms a run takes half the time to make.
    """
    line = quick_yaml.safe_load(LINE_FILE.read_text()) | {"effects": list(effects)}
    plc = quick_yaml.safe_load(PLC_FILE.read_text())
    site = quick_yaml.safe_load(site_file.read_text())
    shown, read = plc["read"], site["gateway"]["read"]
    site["line"]["cycle_ms"] = cycle_ms
    line["sample_time_s"] = 1e-3 * cycle_ms
    site["freshness"]["hold_after_ms"] = 3 * cycle_ms
    for block in (shown, read):
        if not applied:
            block.pop("applied", None)
        if not echo:
            block.pop("aff_echo", None)
    if reference:
        free = 15 + echo + 2 * applied
        shown["channels"][SPEED_REF] = {"address": free, "type": "i16", "scale": 0.001}
        read["channels"][SPEED_REF] = {"register": free, "type": "i16", "scale": 0.001}
    if for_record:
        for name, at, kind, scale in WORDS_FOR_RECORD:
            word = {"type": kind, "scale": scale}
            shown["channels"][name] = {"address": at, **word}
            read["channels"][name] = {"register": at, **word}
        site["rolls"]["unwind"] |= {
            "supplier": "unwind_supplier_number",
            "torque": "unwind_torque_N_m",
            "tension_after": "unwind_tension_N",
        }
    if cancels:
        site["rolls"][cancels] = {"radius_m": 0.0381}
        block = {"roll": cancels, "orders": [1], "settle_s": 4, "amp_limit_m_s": 0.02}
        site["actuators"]["unwind"]["blocks"] = [block]
    paths = [folder / name for name in ("line.yaml", "site.yaml", "plc.yaml")]
    for path, data in zip(paths, (line, site, plc), strict=True):
        path.write_text(quick_yaml.safe_dump(data, sort_keys=False))
    return Files(line=paths[0], site=paths[1], plc_map=paths[2])


class RecordedRun:
    """A bench whose ticks go into a run folder.

    Attributes
    ----------
    bench : plant and runtime; ``run``, ``arm`` and ``inject`` as there.
    recording : whether rows are written.
    folder : writes the run; with ``law_too`` what the law says of its orders as well; with
        ``can_map`` plant and runtime speak CAN by DBC; ``start_utc`` : what its head says;
        ``seed`` : of the plant's noise.
    """

    def __init__(
        self,
        made: Files,
        runs: Path,
        *,
        line_speed_m_s: float = 1.0,
        segment_s: float = 20.0,
        law_too: bool = False,
        can_map: Path | None = None,
        start_utc: str = UTC,
        seed: int = SEED,
    ) -> None:
        site = load_site(made.site)
        setup = Setup(
            line=made.line,
            site=made.site,
            plc_map=made.plc_map,
            line_speed_m_s=line_speed_m_s,
            responses=known_responses(line_speed_m_s, site.cycle_s),
            soft_start_s=1.5,
            seed=seed,
        )
        self.bench = Bench(setup) if can_map is None else CanBench(setup, can_map)
        outputs = [f"{name}_m_s" for name in site.actuators]
        law = self.bench.law.telemetry_names() if law_too else ()
        self._of_law = self.bench.law.telemetry if law_too else tuple
        columns = record_columns(tuple(site.gateway.read.channels), outputs, law)
        meta = RunMeta(heartbeat_modulus=self.bench.heartbeat_modulus)
        self.folder = RunFolder(
            runs,
            replace(head_of(meta, start_utc), columns=tuple(columns)),
            RunContext(name=site.line.name, site_text=made.site.read_text(), segment_s=segment_s),
        )
        self._rows: list[tuple[float, ...]] = []
        self.recording = True
        self._last: deque[tuple[float, ...]] = deque(maxlen=40)
        self.bench.outside.watchers.append(self._take)

    @property
    def path(self) -> Path:
        """The run folder."""
        return self.folder.path

    def truth(self) -> list[tuple[float, ...]]:
        """Return time, true tension and true angle of the follower; it grows from here on."""
        seen: list[tuple[float, ...]] = []
        self.bench.plant.observers.append(
            lambda plant: seen.append((plant.time_s, *(plant.measured[name] for name in TRUTH)))
        )
        return seen

    def set_speed(self, target_m_s: float, seconds: float) -> None:
        """Ramp the speed reference from where it is while the line runs."""
        plant = self.bench.plant
        start_m_s = plant.measured[SPEED_REF]
        steps = max(1, round(seconds / 0.05))
        for step in range(steps):
            share = (step + 1) / steps
            plant.set_reference(SPEED_REF, start_m_s + share * (target_m_s - start_m_s))
            self.bench.run(0.05)

    def goes_on_until(self, time_s: float) -> None:
        """Write the last rows again, as those of a later time; what lies between is not there."""
        self._write()
        later_s = time_s - self._last[-1][0]
        self.folder.add([(row[0] + later_s, *row[1:]) for row in self._last])

    def end(self) -> Path:
        """Write what is left and the summary; return the folder."""
        self._write()
        self.folder.finish(ring_overruns=0)
        return self.path

    def _take(self, row: Sequence[float]) -> None:
        if not self.recording:
            return
        self._rows.append((*row, *self._of_law()))
        self._last.append(self._rows[-1])
        if len(self._rows) >= 50:  # the recorder looks four times a second
            self._write()

    def _write(self) -> None:
        self.folder.add(self._rows)
        self._rows = []
