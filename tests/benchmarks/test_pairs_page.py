"""The page of the pairs: the table goes between its marks, and every pair has its row."""

from benchmarks.pairs import BEGIN, END, FOLDER, PAGE, labels, plan, written
from tests.each_case import each_case


def test_the_table_goes_between_its_marks_and_nothing_else_moves():
    page = f"head\n{BEGIN}| old |\n{END}tail\n"
    assert written(page, "| new |\n") == f"head\n{BEGIN}| new |\n{END}tail\n"


def test_the_page_has_its_marks():
    page = PAGE.read_text(encoding="utf-8")
    assert (page.count(BEGIN), page.count(END)) == (1, 1)


@each_case("run", plan(), ids=lambda r: r.name)
def test_every_run_has_its_row_on_the_page(run):
    label = "; ".join(f"{name} at {place}" for name, place in labels()[run.case]) or "healthy"
    taken = ", ".join(run.without) or "-"
    assert f"| {run.case} | {label} | {taken} |" in PAGE.read_text(encoding="utf-8")


@each_case("run", [r for r in plan() if not r.without], ids=lambda r: r.name)
def test_every_pair_is_whole(run):
    assert [name for name in run.files if not (FOLDER / name).is_file()] == []
