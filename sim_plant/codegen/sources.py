"""The compiled functions as syntax trees, with what their names stand for."""

from __future__ import annotations

import ast
import builtins
import inspect
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """One compiled function; ``plain``: as it was before compilation."""

    name: str
    where: str
    tree: ast.FunctionDef
    plain: Callable[..., Any]

    @property
    def parameters(self) -> list[str]:
        """Names of the parameters, in order."""
        return [given.arg for given in self.tree.args.args]

    def annotation(self, name: str) -> str:
        """Return the text of a parameter's annotation."""
        given = next(a for a in self.tree.args.args if a.arg == name)
        return ast.unparse(given.annotation) if given.annotation is not None else ""

    def meaning(self, name: str) -> Any:
        """Return what a name outside the function's own stands for; None: unknown."""
        return self.plain.__globals__.get(name, getattr(builtins, name, None))


def is_compiled(thing: object) -> bool:
    """Return whether this is a function of the kernel."""
    return inspect.isfunction(getattr(thing, "py_func", None))


@cache
def source_of(function: Any) -> Source:
    """Return the source of a compiled function."""
    plain: Callable[..., Any] = function.py_func
    lines, first = inspect.getsourcelines(plain)
    tree = ast.parse(textwrap.dedent("".join(lines)))
    definition = tree.body[0]
    assert isinstance(definition, ast.FunctionDef)
    ast.increment_lineno(definition, first - 1)
    return Source(plain.__name__, plain.__module__, definition, plain)
