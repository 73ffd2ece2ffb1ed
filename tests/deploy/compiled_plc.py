"""The compiled block as the PLC of a simulated line, in the place of ``Plc``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from aff_runtime.base.signals import Status
from sim_plant.servers.plc import ALL_WELL, Plc, Scan
from sim_plant.servers.plc_map import PlcMap
from tests.deploy.st_compilers import CompiledBlock

WORDS = ("", "watchdog", "state", "rearm", "permissive", "complement", "limit", "scan time")


class CompiledPlc(Plc):
    """A ``Plc`` whose scan is one call of the block; words and counts as the map has them."""

    def __init__(
        self, new_block: Callable[[], CompiledBlock], plc_map: PlcMap, *, status: Status = ALL_WELL
    ) -> None:
        self._new_block = new_block
        self._last_s = 0.0
        self._trips_before = 0
        super().__init__(plc_map, status=status)

    def restart(self) -> None:
        """Start the program again: the block begins with its initial values."""
        super().restart()
        self._trips_before = self.trips
        self.block = self._new_block()

    def scan(
        self, now_s: float, measured: Mapping[str, float], write_words: Sequence[int]
    ) -> Scan:
        """Give the block the words of this scan and show what it decided."""
        plc_map = self.map
        since_s, self._last_s = now_s - self._last_s, now_s
        inputs: dict[str, float] = {
            "AffHeartbeat": plc_map.write_word(write_words, "aff_heartbeat"),
            "AffState": plc_map.write_word(write_words, "state"),
            "ScanTime": since_s,
            "Watchdog": plc_map.watchdog_s,
            "Regain": plc_map.regain_s,
            "FadeTime": plc_map.fade_s,
            "Wanted": Status.AFF_ENABLE_REQUEST in self.status,
            "Permissives": not (plc_map.permissives | Status.AFF_ENABLE_REQUEST) & ~self.status,
        }
        for number, row in enumerate(plc_map.corrections, start=1):
            word = write_words[row.item.address - plc_map.write_start]
            inputs[f"Word{number}"] = word - 0x10000 if word & 0x8000 else word
            inputs[f"Copy{number}"] = write_words[row.complement_address - plc_map.write_start]
            inputs[f"Limit{number}"] = int(row.limit_m_s / row.item.scale * (1.0 + 1e-9))
        out = self.block.call(**inputs)
        self._heartbeat = int(out["PlcHeartbeat"])
        self.withdrawn = bool(out["Withdrawn"])
        self.trips = self._trips_before + int(out["Trips"])
        return self._shown(out, measured)

    def _shown(self, out: Mapping[str, float], measured: Mapping[str, float]) -> Scan:
        status = self.status
        if not out["EnableRequest"]:
            status &= ~Status.AFF_ENABLE_REQUEST
        words = {
            "plc_heartbeat": self._heartbeat,
            "status": int(status),
            "roll_id": self.roll_id,
            "aff_echo": int(out["AffEcho"]),
        }
        rows = list(enumerate(self.map.corrections, start=1))
        applied = {r.item.name: out[f"Applied{n}"] * r.item.scale for n, r in rows}
        return Scan(
            corrections_m_s={r.item.name: out[f"Correction{n}"] * r.item.scale for n, r in rows},
            read_words=self.map.encode_read(words, measured, applied),
            measured=measured,
            applied_m_s=applied,
            refusal=WORDS[int(out["Refusal"])],
        )
