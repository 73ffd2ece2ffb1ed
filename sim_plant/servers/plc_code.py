"""PLC code of the user's in the place of the simulated program: a shared library, `aff_plc.h`.

Map, wire, faults and line stay the simulation's. The library is of this process: two plants in
one process would share its static variables.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.servers.code_watch import CodeWatch
from sim_plant.servers.plc import ALL_WELL, Plc, Scan
from sim_plant.servers.plc_map import PlcMap

_BEGIN, _SCAN = "aff_plc_begin", "aff_plc_scan"


class _Scan(ctypes.Structure):
    """``struct aff_plc_scan``."""

    _fields_ = (
        ("time_s", ctypes.c_double),
        ("since_s", ctypes.c_double),
        ("status", ctypes.c_uint16),
        ("roll_id", ctypes.c_uint16),
        ("measured_count", ctypes.c_uint16),
        ("written_count", ctypes.c_uint16),
        ("shown_count", ctypes.c_uint16),
        ("corrections_count", ctypes.c_uint16),
        ("measured", ctypes.POINTER(ctypes.c_double)),
        ("written", ctypes.POINTER(ctypes.c_uint16)),
        ("shown", ctypes.POINTER(ctypes.c_uint16)),
        ("corrections", ctypes.POINTER(ctypes.c_double)),
    )


class CodePlc(Plc):
    """A ``Plc`` whose scan is the library's: ``trips`` and ``withdrawn`` are unknown and stay.

    A call of the library that does not return ends the process (``CodeWatch``).

    Raises
    ------
    PlantError
        The library cannot be loaded or lacks a function.
    """

    def __init__(self, plc_map: PlcMap, library: Path, *, status: Status = ALL_WELL) -> None:
        self._name = str(library)
        try:
            loaded = ctypes.CDLL(str(library.absolute()))
            self._begin, self._scan = (getattr(loaded, name) for name in (_BEGIN, _SCAN))
        except OSError as error:
            raise PlantError(f"--plc-code {library}: cannot be loaded ({error})") from error
        except AttributeError as error:
            raise PlantError(
                f"--plc-code {library}: no function {_BEGIN} or {_SCAN} in it ({error}); "
                "aff_plc.h says what it must have"
            ) from error
        self._begin.restype, self._scan.restype = None, ctypes.c_int
        self._scan.argtypes = (ctypes.POINTER(_Scan),)
        self._watch = CodeWatch(f"--plc-code {library}")
        self._called_at_s = 0.0  # the time goes on over a restart
        super().__init__(plc_map, status=status)

    def restart(self) -> None:
        """Start the program again: the library begins anew."""
        super().restart()
        with self._watch.call(_BEGIN):
            self._begin()

    def scan(
        self, now_s: float, measured: Mapping[str, float], write_words: Sequence[int]
    ) -> Scan:
        """Give the library this scan's words and readings; return what it decided.

        Raises
        ------
        PlantError
            A correction is no finite number: no drive has such a reference.
        """
        since_s, self._called_at_s = now_s - self._called_at_s, now_s
        readings = [measured[item.name] for item in self.map.channels]
        given = self._before(measured)
        shown = (ctypes.c_uint16 * self.map.read_count)(*given)
        corrections = (ctypes.c_double * len(self._actuators))()
        written = (ctypes.c_uint16 * len(write_words))(*write_words)
        scan = _Scan(
            time_s=now_s,
            since_s=since_s,
            status=int(self.status),
            roll_id=self.roll_id,
            measured_count=len(readings),
            written_count=len(written),
            shown_count=len(shown),
            corrections_count=len(corrections),
            measured=(ctypes.c_double * len(readings))(*readings),
            written=written,
            shown=shown,
            corrections=corrections,
        )
        with self._watch.call(_SCAN):
            refusal = self._scan(scan)
        corrections_m_s = dict(zip(self._actuators, corrections, strict=True))
        for name, value in corrections_m_s.items():
            if not math.isfinite(value):
                raise PlantError(
                    f"--plc-code {self._name}: at {now_s:g} s it adds {value} m/s to the "
                    f"reference of {name}; a drive takes finite numbers"
                )
        words = list(shown)
        applied = {item.name: self.map.read_value(words, item) for item in self.map.applied}
        return Scan(
            corrections_m_s=corrections_m_s,
            read_words=words,
            measured={**measured, **self._changed(given, words)},
            applied_m_s=corrections_m_s | applied,
            refusal=f"code {refusal} of --plc-code" if refusal else "",
        )

    def _changed(self, given: Sequence[int], shown: Sequence[int]) -> dict[str, float]:
        """Return the channels of which the code says something of its own, SI.

        The others keep their readings: a wire without these words may count finer than they do.
        """
        return {
            item.name: self.map.read_value(shown, item)
            for item in self.map.channels
            if self.map.read_slice(given, item) != self.map.read_slice(shown, item)
        }

    def _before(self, measured: Mapping[str, float]) -> list[int]:
        """Return the read block as the library gets it: what the machine measures and says."""
        words = dict.fromkeys(self.map.read, 0) | {
            "status": int(self.status),
            "roll_id": self.roll_id,
        }
        return self.map.encode_read(words, measured, dict.fromkeys(self._actuators, 0.0))
