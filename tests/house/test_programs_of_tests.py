"""Programs among the tests, which no test collects, can at least be begun."""

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BEGINS = 'if __name__ == "__main__":'


def programs():
    """Return the modules below tests/ that are programs."""
    files = (ROOT / "tests").rglob("*.py")
    found = [file for file in files if BEGINS in file.read_text(encoding="utf-8")]
    return sorted(".".join(file.relative_to(ROOT).with_suffix("").parts) for file in found)


def test_there_are_programs_among_the_tests():
    assert "tests.sim_plant.refine.pairs" in programs()


@pytest.mark.parametrize(
    "name", [n for n in programs() if not n.endswith("test_programs_of_tests")]
)
def test_a_program_among_the_tests_has_all_that_it_imports(name):
    importlib.import_module(name)
