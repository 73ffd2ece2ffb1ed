"""What each package of the product shows to the others.

``__all__`` of a package names the modules and packages in it that product code outside of it
imports, or that run as programs, and the names that its ``__init__`` makes. All else is its own.
``python -m tests.house.public_names`` writes every ``__all__`` anew; then ``ruff format``.
"""

import ast
import re
from functools import cache

from benchmarks.house.imports import imported, module_names
from tests.house.documents import ROOT
from tests.house.trees import tree_of

PACKAGES = ("aff_runtime", "sim_plant", "aff_hmi")
KNOWN = module_names(ROOT, PACKAGES)
_ALL = re.compile(r"^__all__\b.*?\]\n", re.MULTILINE | re.DOTALL)
_PROGRAM = 'if __name__ == "__main__":'


def tree(name):
    """Return the syntax tree of a module."""
    return tree_of(KNOWN[name])


def packages():
    """Return the names of all packages of the product."""
    return [name for name, path in KNOWN.items() if path.name == "__init__.py"]


def declared(package):
    """Return ``__all__`` of a package as written, or None where it has none."""
    for node in tree(package).body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        if any(isinstance(one, ast.Name) and one.id == "__all__" for one in targets):
            return ast.literal_eval(node.value)
    return None


def used(package):
    """Return what a package has to name."""
    return sorted({*_shown_modules(package), *_made(package)}, key=_order)


@cache
def _imported(name):
    return tuple(imported(name, tree(name), KNOWN))


def _shown_modules(package):
    """Yield what lies directly in a package and is used outside of it, or runs as a program."""
    inside = f"{package}."
    for name in KNOWN:
        if not f"{name}.".startswith(inside):
            targets = _imported(name)
        elif _PROGRAM in KNOWN[name].read_text(encoding="utf-8"):
            targets = [name]
        else:
            continue
        yield from (t[len(inside) :].split(".")[0] for t in targets if t.startswith(inside))


def _made(package):
    """Yield the public names that the package's own file imports or sets."""
    for node in tree(package).body:
        if isinstance(node, ast.ImportFrom) and node.module != "__future__":
            yield from (alias.asname or alias.name for alias in node.names)
        elif isinstance(node, ast.Assign):
            names = [one.id for one in node.targets if isinstance(one, ast.Name)]
            yield from (n for n in names if n != "__all__" and (n[0] != "_" or n[:2] == "__"))


def _order(name):
    kind = 0 if name.isupper() else 1 if name[0].isupper() else 2
    return kind, name


def write():
    """Write every ``__all__`` anew."""
    for package in packages():
        path = KNOWN[package]
        text = _ALL.sub("", path.read_text(encoding="utf-8")).rstrip() + "\n"
        names = ", ".join(f'"{name}"' for name in used(package))
        line = f"__all__ = [{names}]\n" if names else "__all__: list[str] = []\n"
        path.write_text(f"{text}\n{line}", encoding="utf-8")


if __name__ == "__main__":
    write()
