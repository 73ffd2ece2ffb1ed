"""How a number is declared once: its unit, its bounds, its sentence, when it may change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from annotated_types import MaxLen, MinLen
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic.types import StringConstraints
from pydantic_core import CoreSchema, PydanticCustomError
from pydantic_core.core_schema import no_info_before_validator_function

from aff_runtime.base.printable import printable
from aff_runtime.base.units import UnitError, accepted_units, read_number


class Section(BaseModel):
    """Base of every section: nothing unknown, nothing changes, no NaN, no infinity."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True
    )


@dataclass(frozen=True, slots=True)
class Unit:
    """Mark of a float key: bare numbers are in ``symbol``, text may carry another unit."""

    symbol: str

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Convert text with a unit before the bounds are looked at."""
        return no_info_before_validator_function(self._read, handler(source))

    def _read(self, value: object) -> float:
        try:
            return read_number(value, self.symbol)
        except UnitError as error:
            raise PydanticCustomError("unit", "{reason}", {"reason": str(error)}) from error

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Tell editors that text with a unit is welcome too."""
        units = ", ".join(name for name in accepted_units(self.symbol) if name)
        shown: JsonSchemaValue = {"type": ["number", "string"], "x-unit": self.symbol or "ratio"}
        return shown | ({"x-accepted-units": units} if units else {})


@dataclass(frozen=True, slots=True)
class Whole:
    """Mark of an int key: what is counted; only whole numbers are taken."""

    symbol: str

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Take ints alone; no text, no 5.0, no true; bounds and choices come after."""
        return no_info_before_validator_function(self._read, handler(source))

    @staticmethod
    def _read(value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise PydanticCustomError("int_type", "a whole number is expected")
        return value

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Add the unit to the schema."""
        return handler(schema) | {"x-unit": self.symbol}


def key(
    description: str,
    *,
    default: Any = ...,
    default_factory: Any = None,
    alias: str | None = None,
    live: bool = False,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """Declare one key of the site file.

    Parameters
    ----------
    description : what it does and when to change it, for a technician.
    default, default_factory : value when the key is absent; without both it is required.
    alias : the key in the file where Python needs another name.
    live : True when it may change while a correction is active.
    gt, ge, lt, le : bounds, in the key's own unit.
    """
    given: dict[str, Any] = {} if default_factory is not None else {"default": default}
    if default_factory is not None:
        given["default_factory"] = default_factory
    bounds = {"exclusiveMinimum": gt, "minimum": ge, "exclusiveMaximum": lt, "maximum": le}
    extra = {name: bound for name, bound in bounds.items() if bound is not None}
    return Field(
        description=description,
        alias=alias,
        json_schema_extra={"x-live": live, **extra},
        gt=gt,
        ge=ge,
        lt=lt,
        le=le,
        **given,
    )


def _printing(text: str) -> str:
    """Return ``text``, which goes to logs, screens and records, when all of it shows as itself."""
    for place, char in enumerate(text, 1):
        if not char.isprintable():
            reason = (
                f"{text[:40]} holds {printable(char)} as character {place}, which does not print. "
                "Remove it."
            )
            raise PydanticCustomError("unprintable", "{reason}", {"reason": reason})
    return text


Seconds: TypeAlias = Annotated[float, Unit("s")]
Milliseconds: TypeAlias = Annotated[float, Unit("ms")]
Metres: TypeAlias = Annotated[float, Unit("m")]
MetresPerSecond: TypeAlias = Annotated[float, Unit("m/s")]
MetresPerSecond2: TypeAlias = Annotated[float, Unit("m/s2")]
NewtonMetres: TypeAlias = Annotated[float, Unit("N m")]
NewtonMetresPerSecond: TypeAlias = Annotated[float, Unit("N m/s")]
Newtons: TypeAlias = Annotated[float, Unit("N")]
Pascals: TypeAlias = Annotated[float, Unit("Pa")]
RadiansPerSecond: TypeAlias = Annotated[float, Unit("rad/s")]
Hertz: TypeAlias = Annotated[float, Unit("Hz")]
Radians: TypeAlias = Annotated[float, Unit("rad")]
Turns: TypeAlias = Annotated[float, Unit("turns")]
KilogramMetres2: TypeAlias = Annotated[float, Unit("kg m2")]
KilogramsPerMetre3: TypeAlias = Annotated[float, Unit("kg/m3")]
Ratio: TypeAlias = Annotated[float, Unit("")]
Megabytes: TypeAlias = Annotated[float, Unit("MB")]
SiPerCount: TypeAlias = Annotated[float, Unit("")]  # SI per count
Register: TypeAlias = Annotated[int, Whole("register number")]
Name: TypeAlias = Annotated[
    str, StringConstraints(strict=True, pattern=r"^[a-z][A-Za-z0-9_]*$", max_length=48)
]
Text: TypeAlias = Annotated[
    str, StringConstraints(strict=True, min_length=1, max_length=200), AfterValidator(_printing)
]
Flag: TypeAlias = Annotated[bool, Field(strict=True)]
Few = (MinLen(1), MaxLen(64))
