"""A simulated line behind real sockets, as a test has it in hand."""

from __future__ import annotations

import contextlib
import importlib.util
import math
import os
import select
import shutil
import signal
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import PlantError
from sim_plant.base.shipped import shipped
from sim_plant.pytest_plugin.host_client import ENDED, HostClient
from sim_plant.servers.answers import PlantStatus
from sim_plant.servers.control_client import ask

_PATIENCE_S = 60.0
_LOOK_AGAIN_S = 0.005
_MOST_AT_ONCE = 2_000  # samples of one command, so that none takes long
_PROTOCOLS = ("", "dbc", "canopen")
DEFAULT_LINE = "lines/euclid_ripple.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class LineSetup:
    """How a line is served.

    Attributes
    ----------
    line : its declaration; the shipped line with an out-of-round unwind roll by default.
    stepped : virtual time, turned by ``step``; False for real time.
    udp : Modbus on UDP instead of TCP.
    can : ``dbc`` or ``canopen`` for a CAN bus instead of Modbus.
    seed : of every random number.
    speed_m_s : line speed; the declaration's by default.
    plc : the PLC's words; the shipped gateway block by default.
    plc_code : a library in the place of the PLC's program (``aff_plc.h``).
    words : further words for ``sim-plant serve``.
    """

    line: Path | None = None
    stepped: bool = True
    udp: bool = False
    can: str = ""
    seed: int = 0
    speed_m_s: float | None = None
    plc: Path | None = None
    plc_code: Path | None = None
    words: Sequence[str] = ()

    def __post_init__(self) -> None:
        """Refuse what `sim-plant serve` could not make sense of.

        Raises
        ------
        PlantError
            With what is to be written instead.
        """
        if self.can not in _PROTOCOLS:
            raise PlantError(f"can={self.can!r}: write dbc or canopen")
        if isinstance(self.words, str):
            raise PlantError(f"words={self.words!r}: give a tuple of words")

    def serve_words(self, folder: Path) -> list[str]:
        """Return the words of ``sim-plant serve`` with every socket in ``folder``."""
        words = [os.path.abspath(self.line or shipped(DEFAULT_LINE)), "--no-realtime"]
        words += ["--control", str(folder / "control"), "--seed", str(self.seed)]
        words += ["--stepped"] * self.stepped + ["--udp"] * self.udp
        if self.can:
            words += ["--can", self.can, "--channel", str(folder / "can")]
        else:
            words += ["--modbus", "127.0.0.1:0"]
        if self.speed_m_s is not None:
            words += ["--speed-m-s", str(self.speed_m_s)]
        if self.plc is not None:
            words += ["--plc", os.path.abspath(self.plc)]
        if self.plc_code is not None:
            words += ["--plc-code", os.path.abspath(self.plc_code)]
        return [*words, *self.words]


class WebLine:
    """One served line.

    Attributes
    ----------
    host, port : where its Modbus listens; port 0 on CAN.
    channel : the frame socket of its CAN bus; without a file on Modbus.
    sample_time_s : control sample time, s.

    Raises
    ------
    PlantError
        The line cannot be served; the message holds what it said.
    """

    def __init__(self, host: HostClient, setup: LineSetup) -> None:
        self.host = "127.0.0.1"
        self._setup = setup
        self._processes = host
        self._folder = Path(tempfile.mkdtemp(prefix="web-line-"))
        self._log = self._folder / "log"
        self._hang_ups: list[Callable[[], object]] = []
        self.channel = self._folder / "can"
        self._plant: int | None = None
        self._ended = ""
        try:
            self._plant = host.serve(setup.serve_words(self._folder), self._log)
            ready = self._await_ready(self._plant)
        except BaseException:
            self._end()
            self._clear_away()
            raise
        at = ready.index("sample_time_s")
        self.port = 0 if setup.can else int(ready[at - 1].rpartition(":")[2])
        self.sample_time_s = float(ready[at + 1])

    def tell(self, command: str) -> dict[str, Any]:
        """Return the answer to one command of ``sim-plant tell``.

        Raises
        ------
        PlantError
            The plant refuses the command, or is no longer there.
        """
        try:
            answer = ask(self._folder / "control", command)
        except (OSError, ValueError) as error:
            how = self._end()
            why = f"the line is gone ({how})" if how else "the line does not answer"
            raise PlantError(f"{command}: {why}; it said:\n{self.log}") from error
        if "error" in answer:
            said = str(answer["error"])
            names_it = said.split()[:1] == command.split()[:1]
            raise PlantError(said if names_it else f"{command}: {said}")
        return answer

    def inject(self, fault: str) -> float:
        """Begin a fault, spelt as for ``--fault``; return when it begins, s of plant time.

        Without a start it is in force on return; a stepped line takes one scan of the PLC for it.
        """
        return float(self.tell(f"fault {fault}")["start_s"])

    def clear(self, fault: str = "") -> None:
        """End one fault by its name, or all; they are over on return."""
        self.tell(f"clear {fault}".strip())

    def set(self, name: str, value: float) -> None:
        """Set a reference (``line_speed_ref_m_s``, ``tension_ref_N``) or a status bit (0, 1).

        Raises
        ------
        PlantError
            There is none of that name, or it cannot have that value.
        """
        try:
            number = float(value)
        except (TypeError, ValueError) as error:
            raise PlantError(
                f"set {name}: {value!r} is no number; give one in SI units"
            ) from error
        self.tell(f"set {name} {int(number) if number.is_integer() else number!r}")

    def value(self, channel: str) -> float:
        """Return one channel in SI: ``true_unwind_tension_N``, or as measured without ``true_``.

        NaN where the line has no number.
        """
        value = self.tell(f"value {channel}")["value"]
        return math.nan if value is None else float(value)

    def status(self) -> PlantStatus:
        """Return what the plant does now."""
        return PlantStatus.from_json(self.tell("status"))

    def step(self, samples: int = 1) -> float:
        """Let a stepped line live through ``samples`` samples; return plant time, s."""
        time_s, left = math.nan, samples
        while left > 0 or math.isnan(time_s):
            time_s = float(self.tell(f"step {min(left, _MOST_AT_ONCE)}")["time_s"])
            left -= _MOST_AT_ONCE
        return time_s

    def client(self, **settings: Any) -> Any:
        """Return a connected client; it is closed with the line.

        On Modbus one of pymodbus (0.5 s of patience, no second try); on CAN a python-can bus.
        ``settings`` go to its constructor.

        Raises
        ------
        PlantError
            The line takes no connection, or python-can is not installed.
        """
        client = self._can_bus(**settings) if self._setup.can else self._modbus(**settings)
        self._hang_ups.append(client.shutdown if self._setup.can else client.close)
        return client

    @property
    def log(self) -> str:
        """What the plant has said so far."""
        try:
            return self._log.read_text(encoding="utf-8", errors="replace")
        except FileNotFoundError:
            return ""

    def close(self) -> None:
        """End clients and plant, and take the sockets away; a second time does nothing.

        Raises
        ------
        PlantError
            The plant did not end by itself, or with an error.
        """
        if not self._folder.exists():
            return
        for hang_up in self._hang_ups:
            with contextlib.suppress(OSError):
                hang_up()
        how = self._end()
        said = self.log
        self._clear_away()
        if how:
            raise PlantError(f"the line is gone ({how}); it said:\n{said}")

    def _end(self) -> str:
        """End the plant, if it is there; return how it ended, nothing where all was well."""
        plant, self._plant = self._plant, None
        if plant is not None:
            try:
                self._ended = _how(self._processes.end(plant))
            except PlantError as error:
                self._ended = str(error)
        return self._ended

    def _clear_away(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)

    def _modbus(self, **settings: Any) -> Any:
        from pymodbus import client  # noqa: PLC0415 (only where one is asked for)

        kind = client.ModbusUdpClient if self._setup.udp else client.ModbusTcpClient
        made: Any = kind(self.host, port=self.port, **{"timeout": 0.5, "retries": 0} | settings)
        if not made.connect():
            raise PlantError(f"{self.host}:{self.port}: the line takes no connection")
        return made

    def _can_bus(self, **settings: Any) -> Any:
        if importlib.util.find_spec("can") is None:
            raise PlantError("client() on CAN needs python-can: pip install 'aff-runtime[can]'")
        from sim_plant.pytest_plugin.can_client import WebLineBus  # noqa: PLC0415

        try:
            return WebLineBus(self.channel, **settings)
        except OSError as error:
            raise PlantError(f"{self.channel}: the line takes no connection ({error})") from error

    def _await_ready(self, plant: int) -> list[str]:
        clock = MonotonicClock()
        give_up_ns = clock.now_ns() + int(_PATIENCE_S * 1e9)
        is_over = False
        while clock.now_ns() < give_up_ns:
            rows = self.log.splitlines()
            ready = [row.split() for row in rows if row.startswith("ready ")]
            if ready:
                return ready[0]
            if is_over or (rows and rows[-1].startswith(ENDED)):
                break
            is_over = _is_over_within(plant, _LOOK_AGAIN_S)
        how = self._end() or f"not ready after {_PATIENCE_S:g} s"
        raise PlantError(f"the line cannot be served ({how}); it said:\n{self.log}")


def _how(code: int) -> str:
    """Return how a process ended by its exit code, a signal by its name; nothing for 0."""
    if code < 0:
        names = {known.value: known.name for known in signal.Signals}
        return f"ended by {names.get(-code, f'signal {-code}')}"
    return f"ended with {code}" if code else ""


def _is_over_within(process: int, patience_s: float) -> bool:
    """Return whether a process ends by then, also one that nobody has waited for."""
    try:
        watched = os.pidfd_open(process)
    except ProcessLookupError:
        return True
    try:
        poll = select.poll()
        poll.register(watched, select.POLLIN)
        return bool(poll.poll(patience_s * 1e3))
    finally:
        os.close(watched)
