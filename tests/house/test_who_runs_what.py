"""The printed runbook and the operator's page say alike who runs which command."""

import re
from itertools import takewhile

from tests.house.documents import ROOT, text

HEAD = "| command | run as | because |"


def rows(path: str) -> list[str]:
    lines = iter(text(ROOT / path).partition(HEAD)[2].strip().splitlines())
    table = list(takewhile(lambda line: line.startswith("|"), lines))
    return [re.sub(r"\]\([^)#]*", "](", row) for row in table[1:]]


def test_runbook_and_operators_page_have_the_same_table():
    assert rows("deploy/RUNBOOK.md") == rows("docs/operator.md")
    assert len(rows("docs/operator.md")) >= 9
