"""Two clusters are compared by what their rows say, not by how long it took."""

from benchmarks.campaign.lost_worker import differences


def row(answer="nothing", **more):
    verdict = {"verdict": answer, "effects": [], "holdout": "/tmp/x/b.csv"}
    return (
        {"faults": [], "made_s": 1.0, "refine_s": 2.0, "refine_cpu_s": 1.5}
        | {"refine": {"verdict": verdict, "said": ["took 2 s"], "error": ""}}
        | more
    )


def test_times_and_folders_are_no_difference():
    other = row(made_s=7.0, refine_s=8.0)
    other["refine"] |= {"said": ["took 8 s"]}
    other["refine"]["verdict"] |= {"holdout": "/tmp/y/b.csv"}
    assert differences({1: row()}, {1: other}) == []


def test_another_verdict_another_size_and_a_lost_row_are():
    assert differences({1: row()}, {1: row("traced")}) == ["case 1: verdict"]
    assert differences({1: row()}, {1: row(snr=[0.4])}) == ["case 1: snr"]
    assert differences({1: row(), 2: row()}, {1: row()}) == ["case 2: a row on one side only"]
