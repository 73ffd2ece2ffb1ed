"""Validation errors of the models, said for the technician at file:line:column."""

from __future__ import annotations

from collections.abc import Callable

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from aff_runtime.base.suggest import meant, nearest
from aff_runtime.base.units import UnitError, plain, read_number
from aff_runtime.config.declared import Declared, declared_at, keys_of
from aff_runtime.config.findings import Finding, KeyPath
from aff_runtime.config.quantity import Section
from aff_runtime.config.yaml_marks import MarkedTree

_BOUNDS = {"greater_than", "greater_than_equal", "less_than", "less_than_equal"}
_TOO_LOW = {"greater_than", "greater_than_equal"}


def findings_of(error: ValidationError, tree: MarkedTree, root: type[Section]) -> list[Finding]:
    """Return one finding per validation error; a misspelt key is not also called missing."""
    errors = error.errors(include_url=False)
    misspelt: set[KeyPath] = set()
    for one in errors:
        if one["type"] == "extra_forbidden":
            path = one["loc"]
            near = nearest(str(path[-1]), _siblings(path, root))
            if near is not None:
                misspelt.add((*path[:-1], near))
    found = []
    for one in errors:
        path = one["loc"]
        if one["type"] == "missing" and path in misspelt:
            continue
        if path and path[-1] == "[key]":
            found.append(tree.finding(path[:-1], _bad_name(path), at_key=True))
            continue
        at_key = one["type"] in ("extra_forbidden", "missing")
        found.append(tree.finding(path, _said(one, path, tree, root), at_key=at_key))
    return found


def _siblings(path: KeyPath, root: type[Section]) -> list[str]:
    parent = declared_at(root, path[:-1])
    return list(keys_of(parent.section)) if parent is not None and parent.section else []


def _bad_name(path: KeyPath) -> str:
    return (
        f"{path[-2]} is no name. Begin with a small letter, then letters, digits and "
        "underscores, 48 at most."
    )


def _said(one: ErrorDetails, path: KeyPath, tree: MarkedTree, root: type[Section]) -> str:
    kind, given = one["type"], one["input"]
    declared = declared_at(root, path)
    if kind == "extra_forbidden":
        return f"unknown key. {meant(str(path[-1]), _siblings(path, root))}"
    if kind in ("unit", "unprintable"):
        return str(one["ctx"]["reason"])
    if declared is None:
        return f"{one['msg']}."
    if kind == "missing":
        return f"required key is missing. {declared.description}"
    written = tree.marks[path].written if path in tree.marks else ""
    if kind in _BOUNDS:
        word = "small" if kind in _TOO_LOW else "large"
        return (
            f"{_with_unit(given, written, declared)} is too {word}. Allowed: {declared.allowed()}."
        )
    speaker = _SPEAKERS.get(kind)
    return speaker(given, written, declared) if speaker is not None else f"{one['msg']}."


def _with_unit(given: object, written: str, declared: Declared) -> str:
    unit = (declared.unit or "") if declared.leaf is float else ""
    if isinstance(given, str):  # of a key that may be absent: not yet a number
        try:
            given = read_number(given, unit)
        except UnitError:
            return written or str(given)
    number = plain(float(given)) if isinstance(given, int | float) else str(given)
    if written == f"{number} {unit}":
        return written
    if written and written[-1].isalpha():
        return f"{written} (= {number} {unit})"
    return f"{written or number} {unit}".strip()


def _literal(given: object, written: str, declared: Declared) -> str:
    shown = written or ("a section or list" if isinstance(given, dict | tuple) else str(given))
    near = nearest(shown, declared.choices)
    hint = f" Did you mean {near}?" if near is not None else ""
    return f"{shown[:60]} is not known here.{hint} Write one of: {', '.join(declared.choices)}."


def _whole(given: object, written: str, declared: Declared) -> str:
    shown = written[:40] or "a section or list"
    if isinstance(given, float) and given.is_integer() and abs(given) < 1e15:
        return f"{shown} is not a whole number. Write {int(given)}."
    allowed = ", ".join(declared.choices) or declared.allowed()
    return f"{shown} is not a whole number. Allowed: {allowed}."


def _text(given: object, written: str, declared: Declared) -> str:
    if isinstance(given, bool):
        return f'{written} is a boolean in YAML 1.1, not text. Write "{written}".'
    if isinstance(given, int | float):
        return f'{written} is a number, not text. Write "{written}".'
    return "a section or list stands here. Write one text."


def _flag(given: object, written: str, declared: Declared) -> str:
    return f"{written[:40] or 'a section or list'} is neither true nor false. Write true or false."


def _section(given: object, written: str, declared: Declared) -> str:
    shown = f'"{written[:40]}"' if written else "a list"
    if declared.section is not None:
        keys = ", ".join(keys_of(declared.section))
        return f"{shown} stands where a section is expected. Its keys: {keys}."
    return f"{shown} stands where a table of names is expected. {declared.description}"


def _list(given: object, written: str, declared: Declared) -> str:
    shown = f'"{written[:40]}"' if written else "a section"
    return f"{shown} stands where a list is expected. Write [{written[:40] or '...'}]."


def _count(given: object, written: str, declared: Declared) -> str:
    return f"needs 1 to 64 entries. {declared.description}"


def _length(given: object, written: str, declared: Declared) -> str:
    return f"text of {len(str(given))} characters. Write 1 to 200."


def _name(given: object, written: str, declared: Declared) -> str:
    return (
        f'"{written[:60]}" is no name. Begin with a small letter, then letters, digits and '
        "underscores, 48 at most."
    )


_SPEAKERS: dict[str, Callable[[object, str, Declared], str]] = {
    "literal_error": _literal,
    "int_type": _whole,
    "int_from_float": _whole,
    "string_type": _text,
    "bool_type": _flag,
    "model_type": _section,
    "model_attributes_type": _section,
    "mapping_type": _section,
    "dict_type": _section,
    "tuple_type": _list,
    "too_short": _count,
    "too_long": _count,
    "string_too_short": _length,
    "string_too_long": _length,
    "string_pattern_mismatch": _name,
}


def empty_keys(tree: MarkedTree) -> list[Finding]:
    """Return a finding for every key without a value; an empty key never means a default."""
    found: list[Finding] = []

    def look(value: object, path: KeyPath) -> None:
        if value is None:
            what = "is empty. Write a value, or put # before the key to use its default."
            found.append(tree.finding(path, what, at_key=True))
        elif isinstance(value, dict):
            for name, inner in value.items():
                look(inner, (*path, name))
        elif isinstance(value, tuple):
            for index, inner in enumerate(value):
                look(inner, (*path, index))

    look(tree.values, ())
    return found
