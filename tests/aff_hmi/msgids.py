"""Every text that a reader of the screen may see: of its code, its pages, the service's tables."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from aff_runtime.app.card.steps import STEPS
from aff_runtime.app.commission.link.messages import WORDS as COMMISSION_WORDS
from aff_runtime.app.hand.may import WORDS
from aff_runtime.app.report.block_status import SHAPE_WHY, WHY
from aff_runtime.app.report.block_status import WORDS as ORDER_WORDS
from aff_runtime.app.report.status import PERMISSIVES
from aff_runtime.base.events import TABLE
from aff_runtime.config.declared import walk
from aff_runtime.config.models import Site

FOLDER = Path(__file__).parents[2] / "aff_hmi"
_IN_PAGE = re.compile(r"\b_\('([^']*)'\)")


def marked() -> set[str]:
    """Return what the code marks with ``N_``."""
    found = set()
    for path in FOLDER.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "N_":
                found.add(ast.literal_eval(node.args[0]))
    return found


def of_pages() -> set[str]:
    """Return what the templates translate."""
    text = "".join(p.read_text(encoding="utf-8") for p in (FOLDER / "templates").iterdir())
    return set(_IN_PAGE.findall(text))


def of_service() -> set[str]:
    """Return the sentences of the service's own tables."""
    of_hand = set(WORDS.values()) | set(ORDER_WORDS.values())
    events = {text for event in TABLE for text in (event.text, event.action)}
    of_card = {text for step in STEPS for text in (step.title, step.measured, step.limit)}
    of_hand |= {declared.description for _, declared in walk(Site) if declared.live}
    of_hand |= of_card | set(COMMISSION_WORDS.values()) - {"{name}"}
    return (
        of_hand | events | set(PERMISSIVES.values()) | set(WHY.values()) | set(SHAPE_WHY.values())
    )


def all_texts() -> set[str]:
    """Return them all."""
    return marked() | of_pages() | of_service()
