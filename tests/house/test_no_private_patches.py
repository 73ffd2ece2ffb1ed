"""Tests of refine patch no private name: they build small real records instead."""

import ast
from pathlib import Path

from tests.each_case import each_case

TESTS = Path(__file__).parents[1] / "sim_plant" / "refine"


def private_patches(tree):
    """Return (line, name) of every patch of a name that begins with one underscore.

    ``monkeypatch.setattr(module, "_x", ...)`` and ``setattr("package.module._x", ...)``, and the
    same with ``delattr`` and ``mock.patch``.
    """
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        if called not in ("setattr", "delattr", "patch", "object"):
            continue
        for argument in node.args[:2]:
            text = argument.value if isinstance(argument, ast.Constant) else None
            name = text.rsplit(".", 1)[-1] if isinstance(text, str) else ""
            if name.startswith("_") and not name.startswith("__"):
                found.append((node.lineno, name))
    return found


@each_case("path", sorted(TESTS.rglob("*.py")), ids=lambda p: p.stem)
def test_no_private_name_of_refine_is_patched(path):
    found = private_patches(ast.parse(path.read_text(encoding="utf-8")))
    assert not found, f"{path}: {found}; build a small real record (tests/sim_plant/refine/small)"


@each_case(
    ("text", "names"),
    [
        ('monkeypatch.setattr(claim, "_missed", f)', ["_missed"]),
        ('monkeypatch.setattr("sim_plant.refine.claim._missed", f)', ["_missed"]),
        ('monkeypatch.delattr(claim, "_missed")', ["_missed"]),
        ('mock.patch("sim_plant.refine.claim._missed")', ["_missed"]),
        ('mock.patch.object(claim, "_missed")', ["_missed"]),
        ('monkeypatch.setattr(claim, "claim", f)', []),
        ('monkeypatch.setattr(claim, "__name__", f)', []),
        ('monkeypatch.setitem(table, "_missed", f)', []),
    ],
)
def test_every_way_to_patch_a_private_name_is_seen(text, names):
    assert [name for _, name in private_patches(ast.parse(text))] == names
