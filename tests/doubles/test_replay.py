from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from tests.doubles.replay import ReplayTransport, read_rows


def test_rows_come_back_in_order_and_then_nobody_answers() -> None:
    transport = ReplayTransport([[1, 2], Outcome.TIMEOUT, [3, 4]])
    assert [transport.transact([], 0) for _ in range(4)] == [
        (Outcome.OK, [1, 2]),
        (Outcome.TIMEOUT, []),
        (Outcome.OK, [3, 4]),
        (Outcome.NOT_CONNECTED, []),
    ]


def test_a_replayed_row_cannot_be_spoilt_by_its_reader() -> None:
    row = [1, 2]
    transport = ReplayTransport([row, row])
    transport.transact([], 0)[1].clear()
    assert transport.transact([], 0) == (Outcome.OK, [1, 2])


def test_close_ends_the_replay() -> None:
    transport = ReplayTransport([[1]])
    transport.close()
    assert transport.transact([], 0)[0] is Outcome.NOT_CONNECTED


def test_a_file_holds_words_outcomes_and_remarks(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("# first shift\n0, 65535,7\n\nTIMEOUT # cable\nBAD_REPLY\n1,2,3\n")
    assert read_rows(path) == ((0, 65535, 7), Outcome.TIMEOUT, Outcome.BAD_REPLY, (1, 2, 3))


@pytest.mark.parametrize("line", ["1;2", "late", "1,,2", "65536", "-1,3", "1.0"])
def test_a_line_that_means_nothing_is_named(tmp_path: Path, line: str) -> None:
    path = tmp_path / "run.csv"
    path.write_text(f"1,2\n{line}\n")
    with pytest.raises(ConfigError, match=r"run\.csv:2: "):
        read_rows(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.csv: cannot be read"):
        read_rows(tmp_path / "none.csv")
