"""The page of a fleet: the worst line first, hostile names as text."""

from dataclasses import replace

from sim_plant.fleet.findings import Finding
from sim_plant.fleet.page import by_urgency, write_page

PLAIN = Finding(line="film1", recorded="2026-11-20", verdict="nothing", error_before=1.0)


def test_what_failed_comes_first_then_the_largest_error_and_a_line_stays_together():
    rows = [
        PLAIN,
        replace(PLAIN, line="film2", error_before=9.0, recorded="2026-11-13"),
        replace(PLAIN, line="film2", error_before=1.1),
        replace(PLAIN, line="film3", verdict="failed"),
    ]
    assert [(f.line, f.recorded[-2:]) for f in by_urgency(rows)] == [
        ("film3", "20"),
        ("film2", "20"),
        ("film2", "13"),
        ("film1", "20"),
    ]


def test_the_page_has_size_interval_change_and_link(tmp_path):
    row = replace(
        PLAIN,
        verdict="traced",
        effect="eccentric_roller",
        place="R6",
        size=1e-4,
        size_low=9e-5,
        size_high=1.1e-4,
        unit="m",
        trend=3e-6,
        trend_low=2e-6,
        trend_high=4e-6,
    )
    reports = {"film1": "reports/film1-abc/report.html"}
    write_page([row], ["traced"], reports, tmp_path / "fleet.html")
    text = (tmp_path / "fleet.html").read_text(encoding="utf-8")
    assert "0.0001 m (9e-05 to 0.00011)" in text
    assert "+3e-06 (+2e-06 to +4e-06)" in text
    assert 'href="reports/film1-abc/report.html"' in text
    assert "http" not in text  # nothing is fetched


def test_a_hostile_name_is_text(tmp_path):
    write_page(
        [replace(PLAIN, line="<script>x</script>")], ["nothing"], {}, tmp_path / "fleet.html"
    )
    text = (tmp_path / "fleet.html").read_text(encoding="utf-8")
    assert "<script>" not in text
    assert "&lt;script&gt;x&lt;/script&gt;" in text


def test_looks_are_counted_though_two_are_of_one_line_and_day(tmp_path):
    rows = [PLAIN, replace(PLAIN, verdict="traced"), replace(PLAIN, line="film2")]
    write_page(rows, [f.verdict for f in rows], {}, tmp_path / "fleet.html")
    text = (tmp_path / "fleet.html").read_text(encoding="utf-8")
    assert "2 lines, 3 looks" in text
    assert "2 nothing, 1 traced" in text
