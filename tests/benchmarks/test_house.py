"""The figures of the house: counted by hand on small trees, and beside grimp on the real one."""

import grimp
import pytest

from benchmarks.house.__main__ import main
from benchmarks.house.imports import arrows_between, circles, floors
from benchmarks.house.page import Proof, Revision, page
from benchmarks.house.rooms import read_modules, rooms, whole
from tests.house.documents import ROOT

TREE = {
    "aff_runtime/__init__.py": "",
    "aff_runtime/base.py": "from typing import Any\n\nx: dict[str, Any] = {}\n",
    "aff_runtime/law/__init__.py": '"""Law."""\n',
    "aff_runtime/law/plain.py": "from aff_runtime.base import x\nfrom . import shape\n",
    "aff_runtime/law/shape.py": "import aff_runtime.base\n\n\ndef f():\n    return 1\n",
    "aff_runtime/app.py": "def g():\n    from aff_runtime.law.plain import x\n    return x\n",
}


@pytest.fixture
def tree(tmp_path):
    """Write the small package; return its folder."""
    for name, text in TREE.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path


def test_rooms_floors_and_arrows_are_those_drawn_by_hand(tree):
    found = {room.name: room for room in rooms(read_modules(tree, ["aff_runtime"]))}
    outer, law = found["aff_runtime"], found["aff_runtime.law"]
    assert (outer.rooms, outer.floors, outer.arrows, outer.circles) == (3, 3, 2, 0)
    assert (law.rooms, law.floors, law.arrows) == (2, 2, 1)


def test_functions_and_untyped_mappings_are_counted(tree):
    outer = whole(read_modules(tree, ["aff_runtime"]))
    assert (outer.modules, outer.untyped, outer.long_functions) == (6, 1, 0)
    assert outer.longest == ("app:g", 3)


def test_another_name_for_an_untyped_mapping_counts_where_it_is_used(tmp_path):
    house = tmp_path / "aff_runtime"
    house.mkdir()
    (house / "__init__.py").write_text("", encoding="utf-8")
    (house / "words.py").write_text(
        "from typing import Any\n\nAsked = dict[str, Any]\nTold = Asked\n", encoding="utf-8"
    )
    (house / "uses.py").write_text(
        "from aff_runtime.words import Told\n\n\ndef f(told: Told) -> Told:\n    return told\n",
        encoding="utf-8",
    )
    found = read_modules(tmp_path, ["aff_runtime"])
    assert found["aff_runtime.words"].untyped == 2
    assert found["aff_runtime.uses"].untyped == 2


def test_rooms_of_a_circle_share_a_floor():
    names = ["a", "b", "c", "d"]
    arrows = frozenset({("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")})
    assert circles(names, arrows) == [frozenset({"b", "c"})]
    assert floors(names, arrows) == 3


def test_many_imports_between_two_rooms_are_one_arrow():
    imports = {"p.a.x": {"p.b.x", "p.b.y"}, "p.a.y": {"p.b.x"}, "p.b.x": set(), "p.b.y": set()}
    assert arrows_between(["p.a", "p.b"], imports) == {("p.a", "p.b")}


def test_the_page_has_both_revisions_and_says_what_is_missed(tree):
    now = Revision(name="now", modules=read_modules(tree, ["aff_runtime"]))
    (tree / "aff_runtime/law/shape.py").unlink()
    before = Revision(name="before", modules=read_modules(tree, ["aff_runtime"]))
    shown = page(
        [before, now],
        [
            Proof(what="an effect", commit="a1", files=("a", "b", "c"), most=3),
            Proof(what="a law", commit="a2", files=("a", "b"), most=1),
        ],
    )
    assert "| aff_runtime | `now` | 6 | 14 | 3 | 3 | 2 | 0 | 0 | `app:g` 3 | 1 | 0 |\n" in shown
    assert "| aff_runtime.law | 2 | 3 | 1 | 2 | 1 | 2 | 0 | 1 |  | `shape:f` 2 | 0 | 0 |" in shown
    assert "| an effect | `a1` | 3 | 3 | met |" in shown
    assert "| a law | `a2` | 2 | 1 | missed |" in shown


@pytest.mark.long  # two seconds a package; quick: the arrows of a made tree
@pytest.mark.parametrize("package", ["aff_runtime", "sim_plant"])
@pytest.mark.sweep(every=2)
def test_imports_are_those_that_grimp_finds(package):
    graph = grimp.build_graph(package, cache_dir=None)
    ours = read_modules(ROOT, [package])
    assert set(ours) == graph.modules
    for name, module in ours.items():
        assert module.imports == graph.find_modules_directly_imported_by(name), name


@pytest.mark.long
def test_any_revision_can_be_printed(capsys):
    assert main(["--root", str(ROOT), "--rev", "HEAD"]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("HEAD\n\n| room |")
    assert "\n| aff_runtime.core |" in shown


def test_an_unknown_revision_is_refused_by_name():
    with pytest.raises(SystemExit, match="ls-tree --name-only nowhere"):
        main(["--root", str(ROOT), "--rev", "nowhere"])
