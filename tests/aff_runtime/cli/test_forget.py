"""``aff-runtime forget [ROLL ...]``: what it asks of the service, and what it prints."""

from __future__ import annotations

from typing import Any

import pytest

from aff_runtime.cli import operate
from aff_runtime.cli.main import main

SAID = "forgotten: unwind; kept: swrap_follower"


class Client:
    """A service that answers; ``asked`` is what reached it."""

    def __init__(self) -> None:
        self.asked: list[tuple[str, dict[str, Any]]] = []

    def ask(self, do: str, **arguments: Any) -> dict[str, Any]:
        self.asked.append((do, arguments))
        return {"ok": True, "message": SAID}

    def close(self) -> None:
        pass


@pytest.mark.parametrize(
    ("words", "arguments"),
    [
        ([], {}),  # as every release has asked it
        (["r4", "r5"], {"rolls": ["r4", "r5"]}),
    ],
)
def test_it_names_the_rolls_that_are_given_and_prints_what_the_service_says(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    arguments: dict[str, Any],
) -> None:
    client = Client()
    monkeypatch.setattr(operate, "connect", lambda _: client)
    assert main(["forget", *words]) == 0
    assert client.asked == [("forget", arguments)]
    assert capsys.readouterr().out == f"{SAID}\n"
