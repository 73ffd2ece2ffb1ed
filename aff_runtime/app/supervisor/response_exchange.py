"""A learned response that is another one than before: what is said of it, and whether it waits."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import author_of
from aff_runtime.app.supervisor.response_ledger import ResponseLedger
from aff_runtime.config.revision import SHORT


@dataclass(frozen=True, slots=True, kw_only=True)
class Exchange:
    """One response file with other content.

    Attributes
    ----------
    before, after : short digests, or ``none``.
    is_ours : a probe of this service wrote it.
    """

    file: Path
    before: str
    after: str
    is_ours: bool

    def __str__(self) -> str:
        """Return one line for log and record."""
        source = "probed here" if self.is_ours else "brought from outside"
        return f"{self._change} ({source}; {author_of(self.file)})"

    @property
    def objection(self) -> str:
        """Return why it does not come in while a correction goes out, and what to do."""
        return (
            f"{self._change}: no probe of this service wrote it (`aff-runtime bypass` lets it in; "
            "the former file put back ends this)"
        )

    @property
    def _change(self) -> str:
        return f"{self.file}: response {self.before} -> {self.after}"


def exchanged_responses(
    running: ParameterRecord, parameters: ParameterRecord, ledger: ResponseLedger
) -> list[Exchange]:
    """Return the responses that differ between two parameter records."""
    files = {**running.response_files, **parameters.response_files}
    exchanges = []
    for name, file in files.items():
        text = parameters.responses.get(name)
        if text == running.responses.get(name):
            continue
        exchanges.append(
            Exchange(
                file=file,
                before=_short(running, name),
                after=_short(parameters, name),
                is_ours=text is not None and ledger.knows(file, text),
            )
        )
    return exchanges


def exchanged_wire_files(
    running: ParameterRecord, parameters: ParameterRecord
) -> list[tuple[str, str]]:
    """Return, per DBC or EDS file with other content, what changed and who wrote it."""
    before, after = running.wire_digests, parameters.wire_digests
    return [
        (
            f"{name}: describes the wire, {before[name][:SHORT]} -> {digest[:SHORT]}",
            author_of(parameters.folder / name),
        )
        for name, digest in after.items()
        if before.get(name, digest) != digest
    ]


def _short(parameters: ParameterRecord, name: str) -> str:
    return parameters.learned.get(name, {}).get("response", "none")[:SHORT]
