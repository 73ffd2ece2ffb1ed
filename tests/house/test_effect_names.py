"""An effect is known by name in its own file only: the line and refine ask its catalogue row.

The campaign is other code on purpose; it has a table of its own, one row an effect.
"""

import ast
import re
from pathlib import Path

import pytest

from benchmarks.campaign.effect_table import EFFECTS, LIBRARY
from benchmarks.campaign.report import page
from sim_plant.effects.catalogue import BY_NAME
from tests.each_case import each_case
from tests.house.trees import tree_of

ROOT = Path(__file__).parents[2]
NAMELESS = ("sim_plant/line", "sim_plant/refine", "benchmarks/campaign")
TABLE = ROOT / "benchmarks/campaign/effect_table.py"
EXAMPLE = ROOT / "sim_plant/refine/example.py"  # hides one effect of its choice in two records
TEMPLATES = (".j2", ".html", ".yaml", ".json", ".md", ".txt")
LONG = "|".join(name for name in BY_NAME if "_" in name)
PHRASE = re.compile(rf"(?<![a-z0-9_])({LONG})(?![a-z0-9_])")


ANY = re.compile(rf"\b({'|'.join(BY_NAME)})\b")
"""What is in the text of a file that imports the file of an effect."""


def names_in(text: str) -> set[str]:
    """Return the effects named in a text; a plain word such as slip counts where it stands alone.

    A text may well say that the web slips; as a key or a value it would be the effect.
    """
    whole = text.strip().partition(" at ")[0].replace(" ", "_").replace("-", "_")
    return set(PHRASE.findall(text)) | ({whole} & set(BY_NAME))


def names_in_code(code: str) -> list[tuple[int, str]]:
    """Return (line, effect) of every string constant that names one, parts of f-strings too."""
    return [
        (node.lineno, name)
        for node in ast.walk(ast.parse(code))
        if isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
        for name in sorted(names_in(_text(node.value)))
    ]


def _text(value: str | bytes) -> str:
    return value if isinstance(value, str) else value.decode("latin-1")


def names_in_template(text: str) -> list[tuple[int, str]]:
    """Return (line, effect) of a file that is no code; quoted or as a key a plain word counts."""
    found = set()
    for number, line in enumerate(text.splitlines(), start=1):
        parts = [line, line.partition(":")[0], *re.findall(r"[\"']([^\"']*)[\"']", line)]
        found |= {(number, name) for part in parts for name in names_in(part)}
    return sorted(found)


def said(path: Path) -> list[str]:
    """Return where a file names an effect."""
    text = path.read_text(encoding="utf-8")
    rows = names_in_code(text) if path.suffix == ".py" else names_in_template(text)
    return [f"{path.relative_to(ROOT)}:{line}: {name}" for line, name in rows]


def files(folder: str, *endings: str) -> list[Path]:
    return [p for p in sorted((ROOT / folder).rglob("*")) if p.suffix in endings]


def imported(code: ast.Module) -> set[str]:
    """Return the last names of all that a file imports."""
    found = set()
    for node in ast.walk(code):
        if isinstance(node, ast.Import | ast.ImportFrom):
            module = (node.module or "") if isinstance(node, ast.ImportFrom) else ""
            found |= {name.rpartition(".")[2] for name in (module, *(a.name for a in node.names))}
    return found


@pytest.mark.parametrize("folder", NAMELESS)
def test_no_effect_is_named_outside_its_file(folder: str) -> None:
    paths = [path for path in files(folder, ".py", *TEMPLATES) if path != TABLE]
    found = [row for path in paths for row in said(path)]
    assert not found, "\n".join(["ask the row of the effect for it:", *found])


@pytest.mark.parametrize("folder", NAMELESS)
def test_nobody_imports_the_file_of_one_effect(folder: str) -> None:
    paths = [path for path in files(folder, ".py") if path != EXAMPLE]
    spoken = [path for path in paths if ANY.search(path.read_text(encoding="utf-8"))]
    found = {str(p.relative_to(ROOT)): imported(tree_of(p)) & set(BY_NAME) for p in spoken}
    assert not {path: names for path, names in found.items() if names}


def test_what_the_campaign_names_is_in_the_catalogue_unless_it_is_outside_the_library() -> None:
    assert {row.name for row in LIBRARY} <= set(BY_NAME)
    assert not {row.name for row in EFFECTS if row.outside is not None} & set(BY_NAME)


def test_the_campaigns_page_tells_which_effects_of_the_catalogue_it_does_not_draw() -> None:
    drawn = {row.name for row in LIBRARY if row.forms}
    left = sorted(set(BY_NAME) - drawn)
    told = "Effects of the catalogue that are not drawn: "
    assert f"\n{told}{', '.join(left) or 'none'}.\n" in page([])
    assert f"\n{told}a_new_effect, another.\n" in page(
        [], catalogue=(*drawn, "another", "a_new_effect")
    )


@each_case(
    ("code", "names"),
    [
        ('x = {"roll_bounce": 1}', ["roll_bounce"]),
        ('if h.name == "slip": pass', ["slip"]),
        ('f"torque_ripple at {place}"', ["torque_ripple"]),
        ('TABLE = """\\nbearing_drag: clean it\\n"""', ["bearing_drag"]),
        ('"roll bounce", "roll-bounce"', ["roll_bounce", "roll_bounce"]),
        ('"slip at R1"', ["slip"]),
        ('b"roll_bounce"', ["roll_bounce"]),
        ('"the web may slip at a splice"', []),
        ('"bearing_drag_N_m"', []),
        ("h.effect.splice", []),
    ],
)
def test_a_name_is_seen_in_any_string_and_a_word_is_none(code: str, names: list[str]) -> None:
    assert [name for _, name in names_in_code(code)] == names


def test_a_name_is_seen_in_a_template() -> None:
    page = '<p>{% if e == "slip" %}\nthe web slips at the splice\nsplice: judge\nrate_limit</p>'
    assert names_in_template(page) == [(1, "slip"), (3, "splice"), (4, "rate_limit")]
