"""What the sections of a line declaration are made of."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False, strict=True)]
Tick = Annotated[float, Field(ge=1e-5, allow_inf_nan=False, strict=True)]
"""A drive's; the line is simulated at each, and faster ones only take longer."""
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False, strict=True)]
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]


def _shows(name: str) -> str:
    if not name.isprintable() or len(name) > LONGEST_NAME:
        raise ValueError(f"expected at most {LONGEST_NAME} characters, all of which print")
    return name


LONGEST_NAME = 200
Name = Annotated[str, AfterValidator(_shows)]
"""What stands in tables, figures and on terminals as it is."""


class Section(BaseModel):
    """A part of a declaration: frozen, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")
