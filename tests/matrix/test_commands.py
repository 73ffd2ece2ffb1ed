"""The commands of the fault matrix say what they take before they run anything."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.matrix import __main__ as table
from tests.matrix import live, mutants


@pytest.mark.parametrize("main", [table.main, live.main, mutants.main])
def test_help_runs_nothing(main: Callable[[list[str]], int]) -> None:
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0


@pytest.mark.parametrize(
    ("main", "wrong"),
    [(table.main, "--dox"), (live.main, "profibus"), (mutants.main, "no such mutant")],
)
def test_a_word_that_names_nothing_is_refused(
    main: Callable[[list[str]], int], wrong: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([wrong])
    assert left.value.code == 2
    assert wrong in capsys.readouterr().err
