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
    parameters : complete parameter record when the file is good, else None.
    findings : ``file:line:column  key: text`` per fault, or per warning of a good file.
    """

    parameters: ParameterRecord | None
    findings: tuple[str, ...] = ()

    def checked(self) -> ParameterRecord:
        """Return the record of a good file.

        Raises
        ------
        ConfigError
            With every finding when the file is not good.
        """
        if self.parameters is None:
            raise ConfigError("\n".join(self.findings))
        return self.parameters

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        parameters = None if self.parameters is None else self.parameters.to_json()
        return {"record": parameters, "findings": list(self.findings)}

    @classmethod
    def from_json(cls, said: Any) -> CheckResult:
        """Read ``to_json``'s values back.

        Raises
        ------
        KeyError, TypeError, ValueError
            When they are no result of this release.
        """
        parameters = said["record"]
        return cls(
            parameters=None if parameters is None else ParameterRecord.from_json(parameters),
            findings=tuple(said["findings"]),
        )
