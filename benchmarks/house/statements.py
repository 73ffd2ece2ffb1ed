"""Every statement of a module, without a look into the expressions, which are most of a tree."""

from __future__ import annotations

import ast
from collections.abc import Iterator

_HOLD = ("body", "orelse", "finalbody", "handlers", "cases")
"""The fields in which statements hold statements; an expression holds none."""


def statements(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield every statement of a module, wherever in it it stands."""
    ahead: list[ast.AST] = [tree]
    while ahead:
        node = ahead.pop()
        for field in _HOLD:
            inside = getattr(node, field, ())
            yield from inside
            ahead += inside


def imports_of(tree: ast.Module) -> list[ast.Import | ast.ImportFrom]:
    """Return the imports of a module, wherever in it they stand."""
    return [one for one in statements(tree) if isinstance(one, ast.Import | ast.ImportFrom)]
