"""A number that decides what refine finds stands in its criteria; what stays elsewhere says why.

Criteria have unit and origin, so a number of another kind is no criterion: it has no origin but
its own definition, or no answer depends on it. Of what stands within a function, numbers that are
given by their name are looked at, and defaults: ``rounds=4`` decides, ``2.0 * size`` is a formula.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from tests.each_case import each_case
from tests.house.trees import tree_of

REFINE = Path(__file__).parents[2] / "sim_plant/refine"
CRITERIA = REFINE / "criteria"
KINDS = {
    "limit": "what is too large or takes too long is refused, or done in parts: no other answer",
    "format": "how a file, a word, a library or a random stream is made or numbered",
    "formula": "a number of mathematics, whatever the data",
    "guard": "keeps a division or a solution defined, far below what data resolve",
    "page": "how a page, a picture or a sentence is laid out",
    "example": "the example that is made, not what is found in it",
}
"""Why a number is no criterion, by kind."""
ELSEWHERE = {
    "example.py": {"example": "HIDDEN FIRST_TENSION_N SECOND_TENSION_N PLANS"},
    "fit/projection.py": {"guard": "RIDGE", "limit": "AT_ONCE"},
    "fit/robust_covariance.py": {"formula": "MANY"},
    "fit/spread.py": {"formula": "SPREAD"},
    "fit/start_angles.py": {"limit": "AT_ONCE"},
    "judge/frequencies.py": {"formula": "QUARTER_RAD"},
    "model/simulation_pool.py": {"limit": "LIMIT_S"},
    "model/twin.py": {"format": "WORDS"},
    "records/child.py": {"limit": "LONGEST_OUTPUT_BYTES"},
    "records/in_child.py": {"limit": "MEMORY_BYTES CPU_S WALL_S _HEAD_BYTES"},
    "records/limits.py": {
        "limit": "FILE_BYTES UNPACKED_BYTES VALUES COLUMNS NAME_CHARACTERS LINE_CHARACTERS"
    },
    "records/mdf_formulas.py": {"format": "FORMULA_KINDS", "page": "_FORMULA_SHOWN"},
    "records/run_activity.py": {"format": "LARGEST_STATE_BITS"},
    "records/run_delivery.py": {"guard": "LEAST_COUNT"},
    "records/run_heartbeat.py": {"format": "FEWEST_BITS WORD_BITS HEARTBEAT_COUNTS MOST_BITS"},
    "records/run_record.py": {"limit": "READ_TIMEOUT_S MEMORY_BYTES"},
    "records/sanity.py": {"guard": "SAME_LEVEL_SHARE"},
    "records/text_table.py": {"page": "_CELL_SHOWN"},
    "report/along_web.py": {"page": "FEWEST_IN_A_ROW"},
    "report/outcome.py": {"limit": "RefineRequest.workers"},
    "report/page.py": {"page": "SHOWN_SHIFTS"},
    "report/plots.py": {
        "page": "POINTS SHOWN_S MOST_CHANNELS LEAST_EXPLAINED AROUND_MOMENT_S LEAD_SHARE "
        "HIGHEST_HZ BELOW_FLOOR_DB ABOVE_FLOOR_DB"
    },
    "report/sketch.py": {"page": "WIDTH_IN HEIGHTS_IN LEAST_SHARE _LEFT_OF"},
    "report/tables.py": {"page": "DIGITS"},
    "report/verdict.py": {"format": "VERSION"},
    "report/wording.py": {
        "page": "SMALL_M SMALL_S MOST_DECIMALS SHOWN_ORDERS",
        "guard": "ROUNDING",
    },
    "search/coherence.py": {"formula": "WINDOW_SHARE NO_COUPLING"},
    "search/moment_range.py": {"limit": "LANES"},
    "spectra/coordinates.py": {"formula": "TWO_PI"},
    "without_line/general/effect.py": {"limit": "LATER"},
    "without_line/general/least_squares.py": {"guard": "RIDGE"},
    "without_line/record_filter.py": {
        "limit": "MOST_FILTER_VALUES",
        "format": "RecordDeclaration.outputs RecordDeclaration.taps",
    },
}
"""Constants with a number that are no criteria, by file and kind."""


GIVEN = {
    "example.py": {"example": "duration_s=60.0"},
    "fit/projection.py": {"guard": "rcond=1e-09"},
    "fit/robust_covariance.py": {"guard": "rcond=1e-09"},
    "report/aff_block.py": {"page": "width=88"},
    "report/plots.py": {"page": "alpha=0.3 fontsize=8 fontsize=9 lw=0.7 lw=0.8 lw=0.9 ncols=3"},
    "report/sketch.py": {"page": "fontsize=8 markersize=6 zorder=3"},
    "search/screening.py": {"guard": "rcond=1e-09"},
    "spectra/spectral_lines.py": {"formula": "count=3"},
    "without_line/general/effect.py": {"formula": "order=5"},
    "without_line/general/judging.py": {"limit": "maxsize=4"},
    "without_line/pipeline.py": {"formula": "k=3"},
    "without_line/record_filter.py": {"format": "default=40 le=500"},
}
"""Numbers that are given by their name or as a default, within functions, by file and kind."""
PLAIN = {0, 1, -1, 2}
"""Numbers of which every program has many: an axis, a rank, a first entry."""
BEGINS = r"^(?:[a-z]\w*|(?:    )?[A-Z_][\w, ]*|    \w+(?=:))(?::[^\n=]*)? = "
MAY_HAVE = re.compile(BEGINS + r"(?:.*\b\d|.*[\[({] *(?:#.*)?$)", re.M)
"""A line as such a constant begins: half of the files have none, and need no syntax tree."""


def statements(body: list[ast.stmt], of: str = "") -> Iterator[tuple[str, ast.stmt, bool]]:
    """Yield the statements of a module and its classes: class, statement, is a text below it."""
    for at, node in enumerate(body):
        below = body[at + 1] if at + 1 < len(body) else None
        told = isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
        yield of, node, told
        if isinstance(node, ast.ClassDef):
            yield from statements(node.body, f"{node.name}.")
        elif isinstance(node, ast.If | ast.Try | ast.With):
            inner = [each for each in ast.iter_child_nodes(node) if isinstance(each, ast.stmt)]
            yield from statements(inner, of)


def constants(tree: ast.Module) -> Iterator[tuple[str, bool]]:
    """Yield constants with a number in their value, and whether a text below says what it is.

    The fields of a class are told by its docstring; 0 is none of theirs, but what is not given.
    """
    for of, node, told in statements(tree.body):
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        values = [each.value for each in ast.walk(node.value) if isinstance(each, ast.Constant)]
        numbers = [x for x in values if isinstance(x, int | float) and not isinstance(x, bool)]
        if any(numbers) if of else numbers:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = (each for target in targets for each in ast.walk(target))
            yield from (
                (f"{of}{n.id}", told or bool(of)) for n in names if isinstance(n, ast.Name)
            )


@cache
def found() -> dict[str, dict[str, bool]]:
    """Return the constants with a number, by file outside the criteria."""
    paths = (path for path in sorted(REFINE.rglob("*.py")) if CRITERIA not in path.parents)
    read = (path for path in paths if MAY_HAVE.search(path.read_text(encoding="utf-8")))
    rows = {str(path.relative_to(REFINE)): dict(constants(tree_of(path))) for path in read}
    return {name: row for name, row in rows.items() if row}


def test_a_number_outside_the_criteria_is_of_a_kind_that_is_none() -> None:
    listed = {
        name: {each for names in kinds.values() for each in names.split()}
        for name, kinds in ELSEWHERE.items()
    }
    assert {name: set(row) for name, row in found().items()} == listed
    assert {kind for kinds in ELSEWHERE.values() for kind in kinds} == set(KINDS)


def test_what_is_none_says_what_it_is() -> None:
    """One text may tell of several that stand in a row."""
    assert not [
        f"{name}: {n}" for name, row in found().items() for n, told in row.items() if not told
    ]


@each_case(
    "case",
    [
        ("SHARE = 0.3", ["SHARE"]),
        ("A, B = 1, 2.0", ["A", "B"]),
        ("GRID: tuple[float, ...] = (-0.5, 0.5)", ["GRID"]),
        ("NONE = 0.0", ["NONE"]),
        ("ENDS = {'xatol': 2e-3}", ["ENDS"]),
        ("ENDS = {  # of the search\n    'xatol': 2e-3,\n}", ["ENDS"]),
        ("WIDE = 2.0 * CRITERIA.fit.free_number", ["WIDE"]),
        ("if FAST:\n    STEPS = 4", ["STEPS"]),
        ("class A:\n    rounds: int = 6\n    found: int = 0", ["A.rounds"]),
        ("FIT = CRITERIA.fit\nTOLD = True\nNAME = 'a'\ndef f(): x = 3", []),
    ],
)
def test_every_way_to_write_a_constant_counts(case: tuple[str, list[str]]) -> None:
    text, names = case
    assert [name for name, _ in constants(ast.parse(text))] == names
    assert MAY_HAVE.search(text) or not names


def given(tree: ast.Module) -> Iterator[str]:
    """Yield numbers but plain ones that stand behind a name in a call, or as a default."""
    for node in ast.walk(tree):
        pairs: list[tuple[str, ast.expr | None]] = []
        if isinstance(node, ast.Call):
            pairs = [(each.arg or "", each.value) for each in node.keywords]
        elif isinstance(node, ast.arguments):
            named = [*node.posonlyargs, *node.args]
            last = named[len(named) - len(node.defaults) :]
            pairs = [(a.arg, d) for a, d in zip(last, node.defaults, strict=True)]
            pairs += [(a.arg, d) for a, d in zip(node.kwonlyargs, node.kw_defaults, strict=True)]
        for name, value in pairs:
            number = value.value if isinstance(value, ast.Constant) else None
            is_number = isinstance(number, int | float) and not isinstance(number, bool)
            if is_number and number not in PLAIN:
                yield f"{name}={number!r}"


def test_no_number_that_decides_is_given_within_a_function() -> None:
    listed = {
        name: {e for all_ in kinds.values() for e in all_.split()} for name, kinds in GIVEN.items()
    }
    paths = (path for path in sorted(REFINE.rglob("*.py")) if CRITERIA not in path.parents)
    rows = {str(path.relative_to(REFINE)): set(given(tree_of(path))) for path in paths}
    assert {name: row for name, row in rows.items() if row} == listed
