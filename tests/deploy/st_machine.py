"""Runs one Structured Text function block: blark parses it, this walks its statements."""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

from blark.parse import new_parser, parse_source_code

_INITIAL: dict[str, Any] = {"BOOL": False, "REAL": 0.0, "INT": 0, "UINT": 0, "WORD": 0}
_RANGE = {"INT": (-0x8000, 0x7FFF), "UINT": (0, 0xFFFF), "WORD": (0, 0xFFFF)}
_BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "AND": lambda a, b: a & b,
    "OR": lambda a, b: a | b,
    "XOR": lambda a, b: a ^ b,
    "=": lambda a, b: a == b,
    "<>": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
}
_CONVERSIONS: dict[str, Callable[[Any], Any]] = {
    "INT_TO_WORD": lambda value: value & 0xFFFF,
    "INT_TO_REAL": float,
    "REAL_TO_INT": round,  # to the nearest, a half to the even one, as the standard says
}


@lru_cache
def parsed(text: str) -> Any:
    """Return the one function block of a source text."""
    parsed = parse_source_code(text, parser=_parser())
    if parsed.exception is not None:
        raise parsed.exception
    (block,) = parsed.transform().items
    return block


def statements_of(text: str) -> list[Any]:
    """Return the statements of a block's body, each of those that stand at the margin by itself.

    The parser's time grows with the text, and a mutant changes one statement: the others are
    parsed once.
    """
    body = text.rpartition("END_VAR\n")[2].rpartition("END_FUNCTION_BLOCK")[0]
    found: list[Any] = []
    chunk = ""
    for line in body.splitlines(keepends=True):
        chunk += line
        if line[0] not in " \n" and line.rstrip().endswith(";"):
            block = parsed(f"FUNCTION_BLOCK One\n{chunk}END_FUNCTION_BLOCK\n")
            found += block.body.statements
            chunk = ""
    assert not chunk.strip(), chunk
    return found


def _head(text: str) -> Any:
    """Return the block with its variables alone."""
    return parsed("".join(text.rpartition("END_VAR\n")[:2]) + "END_FUNCTION_BLOCK\n")


@lru_cache
def _parser() -> Any:
    return new_parser(start=["function_block_type_declaration"])  # a fifth less than all of them


class StMachine:
    """One instance of a function block; variables are attributes of ``v``.

    Arithmetic is as on a PLC: an INT, UINT or WORD that leaves its range is an error of the block
    (no controller agrees with another about it), REAL has 32 bits.
    """

    def __init__(self, path: Path) -> None:
        text = path.read_text()
        self._body = statements_of(text)
        self.types: dict[str, str] = {}
        self.v: dict[str, Any] = {}
        self.inputs: set[str] = set()
        for section in _head(text).declarations:
            for row in section.items:
                kind = str(row.init.spec.type)
                for declared in row.variables:
                    name = str(declared.variable.name)
                    self.types[name] = kind
                    given = row.init.value
                    self.v[name] = _INITIAL[kind] if given is None else self._value(given)
                    if type(section).__name__ == "InputDeclarations":
                        self.inputs.add(name)

    def call(self, **inputs: Any) -> dict[str, Any]:
        """Run the body once; inputs not given keep their last value."""
        assert set(inputs) <= self.inputs
        for name, value in inputs.items():
            self._store(name, value)
        self._run(self._body)
        return self.v

    def _run(self, statements: Any) -> None:
        for statement in getattr(statements, "statements", statements):
            kind = type(statement).__name__
            if kind == "AssignmentStatement":
                (target,) = statement.variables
                self._store(str(target.name), self._value(statement.expression))
            elif kind == "IfStatement":
                self._branch(statement)
            else:
                raise AssertionError(f"statement {kind} is beyond the block's language")

    def _branch(self, statement: Any) -> None:
        for clause in (statement, *statement.else_ifs):
            condition = self._value(clause.if_expression)
            assert isinstance(condition, bool)
            if condition:
                if clause.statements is not None:
                    self._run(clause.statements)
                return
        if statement.else_clause is not None:
            self._run(statement.else_clause.statements)

    def _store(self, name: str, value: Any) -> None:
        kind = self.types[name]
        if kind in _RANGE:
            low, high = _RANGE[kind]
            assert isinstance(value, int)
            assert not isinstance(value, bool)
            assert low <= value <= high, f"{name} := {value} leaves {kind}"
        elif kind == "REAL":
            assert not isinstance(value, bool)
            value = struct.unpack("f", struct.pack("f", value))[0]
        else:
            assert isinstance(value, bool)
        self.v[name] = value

    def _value(self, node: Any) -> Any:  # noqa: PLR0911 (one return per kind of expression)
        match type(node).__name__:
            case "SimpleVariable":
                return self.v[str(node.name)]
            case "Integer":
                return int(str(node.value))
            case "HexInteger":
                return int(str(node.value), 16)
            case "Real":
                return float(str(node.value))
            case "Boolean":
                return str(node.value).upper() == "TRUE"
            case "ParenthesizedExpression":
                return self._value(node.expr)
            case "UnaryOperation":
                inner = self._value(node.expr)
                return (not inner) if str(node.op).upper() == "NOT" else -inner
            case "BinaryOperation":
                left, right = self._value(node.left), self._value(node.right)
                return _BINARY[str(node.op).upper()](left, right)
            case "FunctionCall":
                (parameter,) = node.parameters
                return _CONVERSIONS[str(node.name.name)](self._value(parameter.value))
        raise AssertionError(f"expression {type(node).__name__} is beyond the block's language")
