"""Packages name what they show, and nobody reaches past it."""

import ast
import importlib
import subprocess
import sys

from benchmarks.house.statements import imports_of
from tests.each_case import each_case
from tests.house.public_names import KNOWN, declared, packages, tree, used

AGAIN = "run: python -m tests.house.public_names, then ruff format"
HEAVY = ("numba", "scipy", "matplotlib", "jinja2", "pandas", "pyarrow", "asammdf")


@each_case("package", packages())
def test_a_package_names_what_others_use_of_it(package):
    assert declared(package) is not None, AGAIN
    assert sorted(declared(package)) == sorted(used(package)), AGAIN


@each_case("package", packages())
def test_every_public_name_is_there(package):
    module = importlib.import_module(package)
    for name in declared(package) or ():
        if f"{package}.{name}" in KNOWN:
            importlib.import_module(f"{package}.{name}")
        assert hasattr(module, name), name


@each_case("package", packages())
def test_a_package_says_what_it_is(package):
    assert len(ast.get_docstring(tree(package)) or "") >= 10


def _reached_past(name, tree):
    """Yield private names that a module takes from another one."""
    for node in imports_of(tree):
        if isinstance(node, ast.ImportFrom) and node.module != "__future__":
            for alias in node.names:
                if alias.name.startswith("_") and alias.name != "__version__":
                    yield f"{name}: {alias.name} of {node.module}"


def test_no_module_takes_a_private_name_of_another():
    assert [one for name in KNOWN for one in _reached_past(name, tree(name))] == []


def test_a_command_starts_without_heavy_packages():
    commands = ("aff_runtime.cli.main", "sim_plant.cli.main")
    started = "".join(
        f"import {command}\ntry:\n    {command}.main(['--help'])\nexcept SystemExit:\n    pass\n"
        for command in commands
    )
    code = (
        f"import sys\n{started}print([n for n in {HEAVY!r} if n in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stderr.strip() == "[]"


def test_what_an_operator_calls_starts_without_what_reads_a_site_file():
    """Models, numpy and the law: half a second on a small computer, before a word is said."""
    modules = [f"aff_runtime.cli.{name}" for name in ("operate", "status", "top", "roll", "run")]
    heavy = ("numpy", "pydantic", "yaml", "asyncio", "aff_runtime.config.models")
    code = f"import sys, {', '.join(modules)}\nprint([n for n in {heavy!r} if n in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.strip() == "[]"
