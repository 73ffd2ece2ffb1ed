"""Programs among the tests, which no test collects, can at least be begun.

They measure on the benches of the tests (``tests/lockstep``, ``tests/doubles``) and so stand with
them; every other measuring program is in ``benchmarks``.
"""

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BEGINS = '\nif __name__ == "__main__":'
PROGRAMS = sorted(
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for file in (ROOT / "tests").rglob("*.py")
    if BEGINS in file.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_among_the_tests_has_all_that_it_imports(name):
    importlib.import_module(name)
