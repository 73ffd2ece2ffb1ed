"""The parameter record: what the check of a site file hands to the processes that run it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

from aff_runtime.config.models import Site
from aff_runtime.config.revision import learned_digests, revision_with

_LEFT_OUT_EMPTY = ("site_text", "shapes", "counter_ranges_rad")


class ParameterRecord(BaseModel):
    """A checked site and everything that is read for it before the first tick.

    `from_json` leaves out keys that an older or newer release has besides.

    Attributes
    ----------
    site_hash, config_hash : of the site alone; the revision, with what was learned.
    learned : digests of learned files by actuator and kind (``response``, ``shape``).
    permissives : status bits that are needed, in the order in which a missing one is named.
    responses, shapes : texts of learned files by actuator.
    site : as checked, with what a probe identified of its drives filled in.
    drives : which drive's numbers are in use, a sentence per actuator.
    loops : taps of the impulse response by actuator, from the check.
    counter_ranges_rad : after how much the counter of an angle on CAN starts over, by channel.
    response_files, shape_files : where they are kept, by actuator.
    wire_files : texts of the files that describe the wire, by their name in the site file.
    wire_digests : digests of those files.
    folder : of the site file.
    versions : of the packages that made the record.
    site_text : the site file as it was read; empty in the control process, which needs none.
    """

    model_config = ConfigDict(frozen=True, extra="ignore")

    site: Site
    site_text: str = ""
    site_hash: str
    learned: Mapping[str, Mapping[str, str]] = {}
    config_hash: str
    permissives: tuple[str, ...] = ()
    responses: Mapping[str, str] = {}
    loops: Mapping[str, tuple[float, ...]] = {}
    drives: tuple[str, ...] = ()
    counter_ranges_rad: Mapping[str, float] = {}
    response_files: Mapping[str, Path] = {}
    shape_files: Mapping[str, Path] = {}
    wire_files: Mapping[str, str] = {}
    wire_digests: Mapping[str, str] = {}
    folder: Path = Path()
    versions: Mapping[str, str] = {}
    shapes: Mapping[str, str] = {}

    @model_serializer(mode="wrap")
    def _without_empty(self, plain: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {k: v for k, v in plain(self).items() if v or k not in _LEFT_OUT_EMPTY}

    def to_json(self) -> dict[str, Any]:
        """Return plain values for JSON, keys as in the site file."""
        return self.model_dump(mode="json", by_alias=True)

    @classmethod
    def from_json(cls, said: object) -> ParameterRecord:
        """Read ``to_json``'s values back.

        Raises
        ------
        ValueError
            When they are no record of this release.
        """
        return cls.model_validate(said)

    @property
    def version(self) -> str:
        """Version of the runtime that checked the site; empty when the record has none."""
        return self.versions.get("aff-runtime", "")

    @property
    def revision_word(self) -> int:
        """Low 16 bits of the configuration's hash, as the PLC shows it."""
        return int(self.config_hash[-4:], 16)

    def for_control(self) -> ParameterRecord:
        """Return what the control process needs: all but the file's text."""
        return self.model_copy(update={"site_text": ""})

    def starting_from(self, shapes: Mapping[str, str]) -> ParameterRecord:
        """Return a record that carries the learned shapes that a law starts from, by actuator."""
        return self.model_copy(update={"shapes": shapes})

    def with_shapes(self, shapes: Mapping[str, str]) -> ParameterRecord:
        """Return a record whose revision holds the learned shapes that it is started with.

        Parameters
        ----------
        shapes : text of the shape file by actuator.
        """
        learned = learned_digests(self.responses, shapes)
        revision = revision_with(self.site_hash, learned, self.wire_digests)
        return self.model_copy(update={"learned": learned, "config_hash": revision})
