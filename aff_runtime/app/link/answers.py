"""What the service answers to a request, as frozen dataclasses, each with its JSON form."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from aff_runtime.app.link.replies import ProbeResult, Reply
from aff_runtime.base.errors import AffError


class Answer(Protocol):
    """One answer of the request socket."""

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """Yes or no to a request, also the no of a refusal; empty fields are left out of the JSON.

    Attributes
    ----------
    message : why not, or what became of it.
    exit_code : what a command ends with; None leaves it to the command.
    more : further reasons, such as the findings of a site file after the first.
    state : of the guard. ``duration_s`` : how long what was asked will take.
    """

    ok: bool = True
    message: str = ""
    more: tuple[str, ...] = ()
    state: str = ""
    duration_s: float | None = None
    exit_code: int | None = None

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        optional = {
            "message": self.message or None,
            "more": list(self.more) or None,
            "state": self.state or None,
            "duration_s": self.duration_s,
            "exit_code": self.exit_code,
        }
        return {"ok": self.ok, **{k: v for k, v in optional.items() if v is not None}}

    @classmethod
    def from_json(cls, said: Any) -> Done:
        """Read ``to_json``'s values back; a key that is missing is its default, ``ok`` a no."""
        code, more = said.get("exit_code"), said.get("more")
        return cls(
            ok=said.get("ok") is True,
            message=str(said.get("message", "")),
            more=tuple(map(str, more)) if isinstance(more, list) else (),
            state=str(said.get("state", "")),
            duration_s=said.get("duration_s"),
            exit_code=code if isinstance(code, int) else None,
        )


def refusal(error: AffError) -> Done:
    """Return the answer that says no."""
    first, *more = str(error).split("\n")
    return Done(ok=False, message=first, more=tuple(more), exit_code=error.exit_code)


def as_answer(reply: Reply) -> Done:
    """Return a reply of the control process as the answer to who asked."""
    return Done(ok=reply.ok, message=reply.message, state=reply.state, duration_s=reply.duration_s)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptResponse:
    """One measured response and the file that it is kept in.

    The JSON has the response as its own file has it, so that a reader needs one format.
    """

    result: ProbeResult
    file: Path

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON; the response as its own file has it."""
        result = self.result
        return {
            "actuator": result.actuator,
            "sign": result.sign,
            "remarks": list(result.remarks),
            "delay_s": result.delay_s,
            "response": json.loads(result.text),
            "file": str(self.file),
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeDone:
    """What a probe has measured."""

    results: tuple[KeptResponse, ...]
    ok: bool = True

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {"ok": self.ok, "results": [one.to_json() for one in self.results]}

    @classmethod
    def from_json(cls, said: Any) -> ProbeDone:
        """Read ``to_json``'s values back."""
        return cls(results=tuple(_kept(row) for row in said["results"]))


def _kept(row: Any) -> KeptResponse:
    result = ProbeResult(
        actuator=row["actuator"],
        sign=row["sign"],
        remarks=tuple(row["remarks"]),
        delay_s=row["delay_s"],
        text=json.dumps(row["response"]),
    )
    return KeptResponse(result=result, file=Path(row["file"]))
