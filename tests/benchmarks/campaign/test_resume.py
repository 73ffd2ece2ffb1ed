"""A campaign goes on in its own folder and in no other one's."""

import json

import pytest

from benchmarks.campaign import __main__ as campaign


@pytest.fixture
def folder(tmp_path):
    """Two whole rows of seed 103."""
    for number in (0, 1):
        row = dict.fromkeys(campaign.KEYS) | {"number": number, "seed": 103}
        place = campaign.place(tmp_path, number)
        place.parent.mkdir(exist_ok=True)
        place.write_text(json.dumps(row), encoding="utf-8")
    return tmp_path


def test_another_seed_is_not_taken_as_done(folder, monkeypatch, capsys):
    words = ["campaign", "--cases", "2", "--seed", "104", "--out", str(folder)]
    monkeypatch.setattr("sys.argv", words)
    with pytest.raises(SystemExit) as ended:
        campaign.main()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert "holds rows of seed 103; go on with --seed 103, or name another --out" in said
    assert len(list((folder / "rows").iterdir())) == 2


def test_the_same_seed_goes_on_with_the_cases_that_have_no_row(folder, monkeypatch):
    asked = []

    class Nobody:
        def __init__(self, *_, **__):
            pass

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        def run(self, jobs):
            asked.extend(job[:2] for job in jobs)
            return ()

    monkeypatch.setattr(campaign, "Cluster", Nobody)
    assert campaign.run(103, [0, 1, 2], 1, folder, 1e9) == []
    assert asked == [(103, 2)]
