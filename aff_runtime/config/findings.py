"""One finding of a configuration file: where, what was read, what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.base.yaml_places import Place

KeyPath: TypeAlias = Place


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One line for the technician; lines and columns count from 1."""

    file: str
    line: int
    column: int
    path: str
    text: str

    def __str__(self) -> str:
        """Return ``file:line:column  path: text``, the form editors jump to."""
        where = f"{self.file}:{self.line}:{self.column}"
        said = f"{self.path}: {self.text}" if self.path else self.text
        return f"{printable(where)}  {printable(said)}"


def in_file_order(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return findings by line and column; those of one place keep their order."""
    return tuple(sorted(findings, key=lambda finding: (finding.line, finding.column)))


class SiteFileError(ConfigError):
    """A file is refused; ``findings`` says everything that is wrong, in file order."""

    def __init__(self, findings: Iterable[Finding]) -> None:
        self.findings = in_file_order(findings)
        super().__init__("\n".join(str(finding) for finding in self.findings))


def dotted(path: KeyPath) -> str:
    """Return ``("blocks", 0, "settle_s")`` as ``blocks[0].settle_s``."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if text else part
    return text
