"""Secrets that are planted where the screen has them turn up in nothing that it gives away."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")

from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import PASSWORD, Pressed
from tests.aff_hmi.test_gate_table import LOOKED, answer_to


def everything(at: Pressed, cookie: str) -> str:
    """Return every page, every answer and every frame as one text."""
    at.show(State.READY)
    found = []
    for path in LOOKED:
        told: list[Any] = []
        answer_to(at, scope(path, [("host", HOST), ("cookie", cookie)], "http", "GET"), told)
        found.append(json.dumps([str(one) for one in told]))
    assert at.hub.kept is not None
    found += [at.hub.kept.part(topic, "de") for topic in at.hub.kept.topics]
    return "\n".join(found)


def test_no_secret_is_given_away_to_who_only_looks_or_is_somebody_else(
    keeping: Pressed, tmp_path: Path
) -> None:
    anna, bert = keeping.browser("anna"), keeping.browser("bert")
    mistyped = {"name": PASSWORD, "password": PASSWORD}
    keeping.browser().post("/login", mistyped)
    theirs = anna.session()
    secrets = [PASSWORD, anna.cookie.partition("=")[2], theirs.csrf, theirs.account.secret]
    secrets += keeping.file.read_text().split()[2:]
    for cookie in ("", bert.cookie):
        whole = everything(keeping, cookie)
        for secret in secrets:
            assert str(secret) not in whole
    assert theirs.csrf in everything(keeping, anna.cookie)  # it has looked: her own page has hers
    assert keeping.service.notices[-1] == "login refused nobody"
