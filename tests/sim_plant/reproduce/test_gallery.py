"""The gallery is one page that needs no network, with a JSON twin and a table."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.reproduce import gallery
from sim_plant.reproduce.drawing import Panel, bars, draw
from sim_plant.reproduce.entry import Disagreement, Experiment, Result, beyond, row_of_claim
from sim_plant.reproduce.gallery import Done, chosen, markdown, run_all, write_gallery
from tests.sim_plant.reproduce.light_work import named


def result() -> Result:
    x = np.linspace(0.0, 1.0, 20)
    figure = draw([Panel(curves={"a": (x, x), "b": (x, x**2)}, x="x", y="y", marks={"m": 0.5})])
    return Result(
        rows=(
            row_of_claim("peak | height", "2.0 N", 1.98, "N", True, "<measured>"),
            beyond("beyond", float("nan"), "dB", "no claim"),
        ),
        figures=(figure, bars({"a": [1.0, 2.0]}, ["p", "q"], "dB")),
        disagreements=(
            Disagreement(
                what="L", first="one", second="two", difference=2e-9, unit="m", limit=1e-8
            ),
            Disagreement(
                what="M", first="one", second="two", difference=2e-7, unit="m", limit=1e-8
            ),
        ),
    )


EXPERIMENT = Experiment(identity="2.7", chapter=2, title="A title", where="Fig. 2.7", run=result)


@pytest.fixture(scope="module")
def done() -> Done:
    return Done(EXPERIMENT, EXPERIMENT.run())


@pytest.fixture(scope="module")
def folder(done: Done, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("gallery")
    write_gallery([done], made)
    return made


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    (path,) = folder.glob("*.html")
    return path.read_text(encoding="utf-8")


def test_page_stands_alone(page: str) -> None:
    assert not re.search(r'(?:src|href)\s*=\s*"(?!#)', page.replace("xlink:href", "x"))
    assert "<script" not in page
    assert page.count("<svg") == 2


def test_page_shows_claim_number_verdict_and_reason(page: str) -> None:
    for text in ("2.0 N", "1.98 N", ">agree<", "&lt;measured&gt;", "kept", "broken"):
        assert text in page


def test_twin_is_plain_json(folder: Path) -> None:
    twin = json.loads((folder / "reproduction.json").read_text(encoding="utf-8"))
    assert twin[0]["id"] == "2.7"
    assert twin[0]["rows"][0]["ours"] == 1.98
    assert twin[0]["rows"][1]["ours"] is None
    assert [g["within"] for g in twin[0]["disagreements"]] == [True, False]


def test_table_escapes_bars_and_names_broken_promises(done: Done) -> None:
    text = markdown([done])
    assert "| peak \\| height | 2.0 N | 1.98 N | agree | <measured> |" in text
    assert "1e-08 m BROKEN" in text
    assert "1 agree, 0 disagree," in text


def test_the_same_data_draw_the_same_figure(done: Done) -> None:
    assert result().figures == done.result.figures


def test_an_unknown_name_is_refused_with_the_list() -> None:
    with pytest.raises(PlantError, match=r"no such experiment.*T2\.2"):
        chosen(["9.9"])


def test_chosen_keeps_catalogue_order() -> None:
    assert [e.identity for e in chosen(["4.38", "T2.2"])] == ["T2.2", "4.38"]


@pytest.mark.parametrize(
    "work",
    [named, pytest.param(gallery.run_one, marks=pytest.mark.long)],  # that imports for 4 s
    ids=["light", "real"],
)
def test_two_processes_give_what_one_gives(
    work: Callable[[str], Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gallery, "run_one", work)
    seen: list[str] = []
    both = run_all(chosen(["T2.2", "4.38"]), 2, seen.append)
    alone = [work(name) for name in ("T2.2", "4.38")]
    assert [d.result.rows for d in both] == [r.rows for r in alone]
    assert sorted(text.split()[0] for text in seen) == ["4.38", "T2.2"]  # told as they end
