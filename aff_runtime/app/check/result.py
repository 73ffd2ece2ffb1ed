"""What the check of a site file says, from its own process to whoever asked for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.base.errors import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckResult:
    """What the check says of one site file.

    Attributes
    ----------
    record : complete parameter record when the file is good, else None.
    findings : ``file:line:column  key: text`` per fault, or per warning of a good file.
    """

    record: ParameterRecord | None
    findings: tuple[str, ...] = ()

    def checked(self) -> ParameterRecord:
        """Return the record of a good file.

        Raises
        ------
        ConfigError
            With every finding when the file is not good.
        """
        if self.record is None:
            raise ConfigError("\n".join(self.findings))
        return self.record

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        record = None if self.record is None else self.record.to_json()
        return {"record": record, "findings": list(self.findings)}

    @classmethod
    def from_json(cls, said: Any) -> CheckResult:
        """Read ``to_json``'s values back.

        Raises
        ------
        KeyError, TypeError, ValueError
            When they are no result of this release.
        """
        record = said["record"]
        return cls(
            record=None if record is None else ParameterRecord.from_json(record),
            findings=tuple(said["findings"]),
        )
