"""Formulas in MDF files: found wherever a conversion can sit, refused, and never evaluated.

MDF lets a channel's conversion be an expression in text (MDF 4 algebraic, MDF 3 formula). asammdf
hands it to numexpr, which compiles and runs it after a filter of characters that can be evaded,
or to sympy where that is installed.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.refine.records.limits import path_text

FORMULA_KINDS = {"asammdf.blocks.v4_blocks": 3, "asammdf.blocks.v2_v3_blocks": 10}
"""Modules of asammdf that evaluate text, and the conversion type of a formula in each."""
OWN_TEXTS = {
    "asammdf.blocks.v4_constants": ("CONV_RAT_TEXT",),
    "asammdf.blocks.v2_v3_constants": (
        "RAT_CONV_TEXT",
        "POLY_CONV_SHORT_TEXT",
        "POLY_CONV_LONG_TEXT",
    ),
}
"""asammdf's own texts, for rational and polynomial conversions: numbers of the file go in."""
_FORMULA_SHOWN = 120
"""Characters of a formula that an error quotes."""


def refuse_formulas(path: Path, mdf: Any) -> None:
    """Refuse an open MDF file in which a conversion is a formula; no sample has been read.

    Looked at are all channels, masters included, the axes of arrays, and every conversion that
    another refers to.

    Raises
    ------
    PlantError
        With the channel, the formula and what to do.
    """
    for name, conversion in _conversions(mdf):
        formula = getattr(conversion, "formula", "")
        if formula or _is_formula(conversion):
            raise PlantError(refusal(path, formula, f"channel {printable(name, 60)}: "))


def refusal(path: Path, formula: str, where: str = "") -> str:
    """Return the sentence about a formula."""
    return (
        f"{path_text(path)}: {where}its conversion is the formula "
        f"'{printable(formula, _FORMULA_SHOWN)}', code that comes with the file and is not run; "
        "export the record with raw or with physical values"
    )


@contextmanager
def nothing_evaluated(path: Path) -> Iterator[None]:
    """Take evaluation of text away from asammdf while one of its files is open.

    The second barrier behind `refuse_formulas`, for a conversion it does not see or that runs
    while a file is opened. asammdf goes on over an error of an evaluation and returns raw values,
    so what it asked for is kept and refused at the end.

    Raises
    ------
    PlantError
        A formula was to be evaluated, or this asammdf evaluates by other names.
    """
    own = _own_texts()
    asked: list[str] = []
    put_back: list[tuple[Any, str, Any]] = []
    try:
        for module_name in FORMULA_KINDS:
            module = importlib.import_module(module_name)
            replaced = {"evaluate": _evaluating(own, module, asked), "lambdify": _refusing(asked)}
            for name, guard in replaced.items():
                if not hasattr(module, name):
                    raise PlantError(
                        f"{path_text(path)}: this version of asammdf may evaluate formulas of the "
                        "file; pip install 'asammdf>=8.5,<9'"
                    )
                put_back.append((module, name, getattr(module, name)))
                setattr(module, name, guard)
        yield
    finally:
        for module, name, value in put_back:
            setattr(module, name, value)
        if asked:
            raise PlantError(refusal(path, asked[0]))


def _own_texts() -> frozenset[str]:
    return frozenset(
        getattr(importlib.import_module(module), name)
        for module, names in OWN_TEXTS.items()
        for name in names
    )


def _evaluating(own: Collection[str], module: Any, asked: list[str]) -> Callable[..., Any]:
    """Return the module's ``evaluate`` for asammdf's own texts; others are kept and refused."""
    evaluate = getattr(module, "evaluate", None)

    def guarded(text: str) -> Any:
        if evaluate is None or text not in own:
            asked.append(text)
            raise TypeError("formulas are not evaluated")
        # names of a text are those of its caller: numexpr looks there the same way
        return evaluate(text, local_dict=sys._getframe(1).f_locals)  # noqa: SLF001

    return guarded


def _refusing(asked: list[str]) -> Callable[..., Any]:
    """Return a ``lambdify`` that keeps and refuses every text."""

    def guarded(_symbols: Any, text: str, **_options: Any) -> Any:
        asked.append(text)
        raise TypeError("formulas are not evaluated")

    return guarded


def _conversions(mdf: Any) -> Iterator[tuple[str, Any]]:
    """Yield every conversion of an open file with the name of its channel, nested ones too."""
    for group in mdf.groups:
        for channel in group.channels:
            yield from _nested(channel.name, channel.conversion)
        for blocks in getattr(group, "channel_dependencies", None) or ():
            for block in blocks if isinstance(blocks, list) else ():
                for axis in range(getattr(block, "dims", 0)):
                    conversion = getattr(block, f"axis_conversion_{axis}", None)
                    yield from _nested("axis of an array", conversion)


def _nested(name: str, conversion: Any) -> Iterator[tuple[str, Any]]:
    waiting, seen = [conversion], set()
    while waiting:
        one = waiting.pop()
        if one is None or isinstance(one, bytes | str) or id(one) in seen:
            continue
        seen.add(id(one))
        yield name, one
        waiting += (getattr(one, "referenced_blocks", None) or {}).values()


def _is_formula(conversion: Any) -> bool:
    """Return whether a conversion's type says that it is a formula, even one without text."""
    kind = FORMULA_KINDS.get(type(conversion).__module__)
    return getattr(conversion, "conversion_type", None) == kind
