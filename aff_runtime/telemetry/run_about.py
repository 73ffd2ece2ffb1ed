"""``run.yaml``: what a run is, for whoever reads it later."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import yaml

from aff_runtime.base.printable import printable
from aff_runtime.base.runs.site_in_force import SITE_SHA256
from aff_runtime.base.text_digest import text_digest
from aff_runtime.base.yaml_places import SafeLoader
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext


@dataclass(frozen=True, slots=True, kw_only=True)
class RunAbout:
    """The contents of ``run.yaml``: what the supervisor and the control process say of a run.

    The site file is no part of it; it lies beside it as ``site.yaml``. The hash of its text is.
    """

    context: RunContext
    meta: RunMeta
    start_utc: str
    columns: tuple[str, ...]

    def encode(self) -> str:
        """Return the text of ``run.yaml``; its texts are made printable (``base.printable``)."""
        said = asdict(self.context)
        # a file of its own, and what is for the recorder that takes over alone
        for name in ("site_text", "takes_over", "died"):
            del said[name]
        said = _printable({**said, **self.meta.to_json()})
        said["start_utc"] = self.start_utc
        site_text = self.context.site_text
        said[SITE_SHA256] = text_digest(site_text) if site_text else ""
        said["columns"] = list(self.columns)
        return yaml.safe_dump(said, sort_keys=False, allow_unicode=True)

    @classmethod
    def decode(cls, text: str) -> RunAbout:
        """Read ``encode``'s text back; a run of an earlier release has fewer keys.

        Raises
        ------
        KeyError, TypeError, AttributeError, yaml.YAMLError
            When it is no ``run.yaml``.
        """
        said = yaml.load(text, Loader=SafeLoader)
        return cls(
            context=RunContext.from_json(said),
            meta=RunMeta.from_json(said),
            start_utc=str(said.get("start_utc", "")),
            columns=tuple(said["columns"]),
        )


def _printable(value: Any) -> Any:
    """Return plain values whose texts, keys among them, are made printable."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, Mapping):
        return {printable(str(key)): _printable(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_printable(inner) for inner in value]
    return value
