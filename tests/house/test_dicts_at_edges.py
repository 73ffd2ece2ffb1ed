"""A dict of anything is met where JSON or YAML begins and ends, and nowhere else."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

from benchmarks.house.imports import module_names
from benchmarks.house.untyped import Kind, Known, known_names, other_names, untyped

ROOT = Path(__file__).parents[2]
PRODUCT = ("aff_runtime", "sim_plant", "aff_hmi")
MOST = 40
ANYTHING = {"Any", "object"}
EDGES = {
    "aff_runtime/app/check/result.py": "JSON of the check",
    "aff_runtime/app/commission/link/answers.py": "JSON of the commissioner",
    "aff_runtime/app/link/answers.py": "JSON of the request socket",
    "aff_runtime/app/link/parameter_record.py": "JSON of the check and the link",
    "aff_runtime/app/link/request_client.py": "JSON of the request socket",
    "aff_runtime/app/link/requests.py": "JSON of the request socket",
    "aff_runtime/app/report/comparison/page.py": "JSON of a comparison",
    "aff_runtime/app/report/status_answer.py": "JSON of the status",
    "aff_runtime/base/yaml_section.py": "YAML of a run folder",
    "aff_runtime/cli/terminal.py": "JSON for scripts",
    "aff_runtime/config/quantity.py": "keyword arguments of pydantic",
    "aff_runtime/telemetry/header.py": "JSON of the ring, YAML of a run",
    "sim_plant/base/jit.py": "keyword arguments of numba",
    "sim_plant/cli/tell.py": "JSON for scripts",
    "sim_plant/line/declared/declaration.py": "YAML of a line file",
    "sim_plant/pytest_plugin/web_line.py": "JSON of the control socket",
    "sim_plant/refine/records/child.py": "JSON of the record reader",
    "sim_plant/refine/records/in_child.py": "JSON of the record reader",
    "sim_plant/refine/records/run_site.py": "YAML of a run folder",
    "sim_plant/refine/report/aff_block.py": "YAML for a site file",
    "sim_plant/refine/report/amend.py": "YAML of a line file",
    "sim_plant/refine/report/verdict.py": "JSON of the verdict",
    "sim_plant/base/yaml_edit.py": "YAML of a line file",
    "sim_plant/refine/without_line/verdict.py": "JSON of the verdict",
    "sim_plant/reproduce/gallery.py": "JSON of the gallery",
    "sim_plant/servers/answers.py": "JSON of the control socket",
    "sim_plant/servers/control_client.py": "JSON of the control socket",
}


@cache
def product() -> dict[str, ast.Module]:
    """Return the product's modules by dotted name, as far as any word of theirs can mean one.

    A dict of anything needs a word for anything, or one that was made of such a word; of a
    thousand modules four fifths have neither, and to read them all takes 3 s.
    """
    texts = {name: path.read_text("utf-8") for name, path in module_names(ROOT, PRODUCT).items()}
    trees: dict[str, ast.Module] = {}
    words: set[str] = set()
    while words < (words := words | ANYTHING | made_in(known_names(trees))):
        is_said = re.compile(rf"\b({'|'.join(words)})\b")
        trees |= {name: ast.parse(text) for name, text in texts.items() if is_said.search(text)}
        texts = {name: text for name, text in texts.items() if name not in trees}
    return trees


def made_in(known: Known) -> set[str]:
    """Return every word for anything and for a dict of it, without what it is said of."""
    return {
        word.rpartition(".")[2]
        for names in known.values()
        for word, kind in names.items()
        if kind is not Kind.MAPPING
    }


@cache
def known() -> Known:
    """Return what each of them calls such a dict."""
    return known_names(product())


@cache
def counted() -> dict[str, int]:
    """Return how often each product file says it, by whatever name."""
    names = module_names(ROOT, PRODUCT)
    counts = untyped(product(), known())
    return {str(names[name].relative_to(ROOT)): n for name, n in counts.items() if n}


def test_a_dict_of_anything_is_an_edge() -> None:
    assert set(counted()) == set(EDGES)


def test_there_are_few() -> None:
    assert sum(counted().values()) <= MOST


def test_no_file_has_another_name_for_it() -> None:
    assert not {name: words for name, words in other_names(known()).items() if words}


def uses(**texts: str) -> dict[str, int]:
    return untyped({f"p.{name}": ast.parse(text) for name, text in texts.items()})


def test_another_name_counts_at_every_use_whatever_it_is_called() -> None:
    made = "from typing import Any\nSaid = dict[str, Any]\nRows = list[Said]\nSeen = Said | None\n"
    taken = "from p.made import Rows as R, Seen\ndef f(a: R, b: Seen) -> R: ...\n"
    whole = "from p import made\nimport p.made as m\ndef f(a: made.Said) -> m.Rows: ...\n"
    assert uses(made=made, taken=taken, whole=whole) == {"p.made": 3, "p.taken": 3, "p.whole": 2}


def test_a_name_for_anything_or_for_a_mapping_hides_nothing() -> None:
    json = "from typing import Any as X\nfrom collections.abc import Mapping as M\nx: M[str, X]\n"
    plain = "import typing\nJson = typing.Any\nx: dict[str, Json]\ny: typing.Dict[int, object]\n"
    assert uses(json=json, plain=plain) == {"p.json": 1, "p.plain": 2}


def test_what_is_typed_or_no_name_for_it_is_not_counted() -> None:
    typed = "from typing import Any\nx: dict[str, list[Any]] = {}\nTABLE = {str: Any}\ny = TABLE\n"
    other = "from q import Said\ndef f(a: Said, b: Callable[..., Any]) -> Said: ...\n"
    assert uses(typed=typed, other=other) == {"p.typed": 0, "p.other": 0}
