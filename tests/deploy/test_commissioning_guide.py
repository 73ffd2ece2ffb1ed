"""The commissioning guide says the bits that the runtime reads."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.base.signals import Status

GUIDE = Path(__file__).parents[2] / "deploy" / "plc" / "COMMISSIONING.md"


def test_every_status_bit_stands_in_the_guide_with_its_value() -> None:
    text = GUIDE.read_text()
    assert [bit.name for bit in Status if f"{bit.name} = {bit.value}" not in text] == []
