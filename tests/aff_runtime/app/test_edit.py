"""The diff of two parameter records, key by key."""

from __future__ import annotations

from typing import Any

import pytest

from aff_runtime.app.edit import changes

SITE: dict[str, Any] = {
    "line": {"cycle_ms": 5.0},
    "actuators": {"unwind": {"blocks": [{"orders": [1, 2], "settle_s": 6.0}]}},
}


def edited(**block: Any) -> dict[str, Any]:
    return {
        **SITE,
        "actuators": {"unwind": {"blocks": [{**{"orders": [1, 2], "settle_s": 6.0}, **block}]}},
    }


@pytest.mark.parametrize(
    ("after", "said"),
    [
        (SITE, []),
        (edited(settle_s=9.0), ["actuators.unwind.blocks[0].settle_s: 6.0 -> 9.0"]),
        (edited(orders=[1]), ["actuators.unwind.blocks[0].orders: [1, 2] -> [1]"]),
        (edited(enabled=False), ["actuators.unwind.blocks[0].enabled: (absent) -> False"]),
        (
            {"line": {"cycle_ms": 10.0}, "actuators": {"unwind": {"blocks": []}}},
            [
                "line.cycle_ms: 5.0 -> 10.0",
                "actuators.unwind.blocks: [{'orders': [1, 2], 'settle_s': 6.0}] -> []",
            ],
        ),
    ],
)
def test_each_changed_key_is_named_with_both_values(
    after: dict[str, Any], said: list[str]
) -> None:
    assert [str(change) for change in changes(SITE, after)] == said
