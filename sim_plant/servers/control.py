"""Line-based control of a running plant on a unix socket: look at it, set it, break it.

status                      one JSON object: what is applied at the plant, true tensions, counts
history N                   time and applied corrections of the last N samples
set REFERENCE VALUE         line_speed_ref_m_s, tension_ref_N, travel_NAME_m_s: the speed of an
                            accumulator that has a drive of its own, or unwind_supplier_number
set STATUS_BIT 0|1          any bit of the status word
fault SPEC                  as ``--fault``; a start counts from now; answers it in plant time
clear [NAME]                end one fault, or all; of `splice` it calls a `roll` off
value CHANNEL               one channel as the line has it now: true_... or as measured
step N                      take N samples; of a plant that is served --stepped alone
roll                        full rolls at both ends, on the run; announced as a splice for 2 s;
                            starts a line again whose web was at its end
reset                       forget the largest correction seen

Every command is answered by one line of JSON; an ``error`` key says what was wrong. ``set``,
``clear`` and a ``fault`` that begins now are answered when they are in force: after the PLC's next
scan, whose samples a stepped plant takes for them.
"""

from __future__ import annotations

import asyncio
import json
import os
import socket
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from aff_runtime.base.errors import AffError, PlantError, RefusedError
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import Status
from aff_runtime.base.socket_file import identity, listens, make_room, remove_own
from sim_plant.servers.answers import Answer, Done, History, PlantStatus, Refused, Value, to_json
from sim_plant.servers.faults import fault_named, parse_fault
from sim_plant.servers.plant import Plant

_TAKES_A_SCAN = frozenset({"set", "fault", "clear"})


class ControlledClock(Protocol):
    """The time of the plant, as far as commands have to do with it."""

    async def in_force(self) -> None:
        """Return when the PLC's next scan is over; ``AffError`` when the wire is not back."""
        ...

    async def step(self, samples: int) -> None:
        """Take ``samples`` samples; ``AffError`` where they, or the wire after them, fail."""
        ...


class ControlSocket:
    """Serves the commands to whoever may open the socket file (its owner alone)."""

    def __init__(
        self,
        path: Path,
        plant: Plant,
        status: Callable[[], PlantStatus],
        clock: ControlledClock | None = None,
    ) -> None:
        self._clock = clock
        self._path = path
        self._plant = plant
        self._status = status
        self._server: asyncio.Server | None = None
        self._made = (0, 0)

    async def open(self) -> None:
        """Listen; a socket left behind by an earlier run is replaced.

        Raises
        ------
        PlantError
            The path cannot be used, or another plant listens there.
        """
        if listens(self._path, socket.SOCK_STREAM):
            raise PlantError(
                f"{self._path}: another plant listens there. Stop it, or name another --control"
            )
        try:
            make_room(self._path, "name another --control")
            mask = os.umask(0o177)
            try:
                self._server = await asyncio.start_unix_server(self._serve, self._path)
            finally:
                os.umask(mask)
            self._made = identity(self._path)
        except RefusedError as error:
            raise PlantError(f"cannot open control socket {error}") from None
        except OSError as error:
            raise PlantError(f"cannot open control socket {self._path}: {error}") from error

    async def close(self) -> None:
        """Stop listening and remove the file, if it is still ours."""
        if self._server is not None:
            self._server.close()
            remove_own(self._path, self._made)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            while line := await reader.readline():
                answer = await self.answer(line.decode("utf-8", errors="replace"))
                writer.write(json.dumps(to_json(answer)).encode() + b"\n")
                await writer.drain()
        except (OSError, ValueError, asyncio.CancelledError):
            pass  # the client went away, its line was endless, or the plant stops
        finally:
            writer.close()

    async def answer(self, line: str) -> Answer:
        """Obey one command line and return when it is in force; at once without a clock."""
        words = line.split()
        if words[:1] == ["step"] and self._clock is not None:
            return await self._step(words[1:], self._clock)
        answer = self._obey(words)
        if self._clock is not None and isinstance(answer, Done) and words[0] in _TAKES_A_SCAN:
            begins_s = answer.start_s or 0.0
            try:
                if begins_s <= self._plant.time_s:
                    await self._clock.in_force()
            except AffError as error:
                return Refused(error=str(error))
            answer = replace(answer, time_s=self._plant.time_s)
        return answer

    async def _step(self, arguments: list[str], clock: ControlledClock) -> Answer:
        try:
            await clock.step(int(arguments[0]) if arguments else 1)
        except ValueError:
            return Refused(error=f"step {arguments[0]}: write a whole number of samples")
        except AffError as error:
            return Refused(error=str(error))
        return Done(time_s=self._plant.time_s)

    def _obey(self, words: list[str]) -> Answer:
        commands: dict[str, Callable[[list[str]], Answer]] = {
            "status": lambda _: self._status(),
            "history": self._history,
            "set": self._set,
            "fault": self._fault,
            "clear": self._clear,
            "value": self._value,
            "roll": lambda _: Done(change_s=self._plant.change_rolls()),
            "reset": self._reset,
        }
        if not words or words[0] not in commands:
            return Refused(error=f"unknown command; known are {', '.join(commands)}, step")
        try:
            return commands[words[0]](words[1:])
        except AffError as error:
            return Refused(error=str(error))
        except (ValueError, IndexError):
            said = " ".join(words[1:]) or "nothing"
            return Refused(
                error=f"{words[0]}: wrong or missing argument: read {printable(said, 60)}; "
                "`sim-plant tell --help` says what each takes"
            )

    def _history(self, arguments: list[str]) -> History:
        rows = self._plant.history(int(arguments[0]))
        return History(
            actuators=list(self._plant.applied_m_s),
            time_s=[time_s for time_s, _ in rows],
            applied_m_s=[applied for _, applied in rows],
        )

    def _set(self, arguments: list[str]) -> Done:
        name, value = arguments
        if name in self._plant.references:
            self._plant.set_reference(name, float(value))
        elif name in Status.__members__ and value in {"0", "1"}:
            self._plant.set_status(Status[name], value == "1")
        else:
            known = ", ".join((*self._plant.references, *Status.__members__))
            raise PlantError(f"cannot set {name} to {value}; known are {known} (bits 0 or 1)")
        return Done()

    def _fault(self, arguments: list[str]) -> Done:
        placed = self._plant.inject(parse_fault(arguments[0]))
        return Done(start_s=placed.start_s)

    def _clear(self, arguments: list[str]) -> Done:
        self._plant.clear(fault_named(arguments[0]) if arguments else None)
        return Done()

    def _value(self, arguments: list[str]) -> Value:
        measured, name = self._plant.measured, arguments[0]
        if name not in measured:
            raise PlantError(f"value {name}: no such channel; there are {', '.join(measured)}")
        value = measured[name]
        return Value(time_s=self._plant.time_s, value=finite_or_none(value))

    def _reset(self, arguments: list[str]) -> Done:
        del arguments
        self._plant.reset_extremes()
        return Done()
