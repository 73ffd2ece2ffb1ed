"""The commissioning guide says the bits that the runtime reads."""

from __future__ import annotations

from pathlib import Path

import cantools
import pytest

from aff_runtime.base.signals import StateBits, Status
from aff_runtime.config.loader import load_site
from tests.each_case import each_case

CONFIG = Path(__file__).parents[2] / "config"
GUIDE = Path(__file__).parents[2] / "deploy" / "plc" / "COMMISSIONING.md"
BLOCK = Path(__file__).parents[2] / "docs" / "technician" / "gateway-block.md"


@each_case("page", [GUIDE, BLOCK], ids=lambda page: page.stem)
@each_case("bits", [Status, StateBits])
def test_every_bit_of_both_words_stands_on_the_plcs_pages_with_its_value(
    page: Path, bits: type[Status | StateBits]
) -> None:
    text = page.read_text()
    assert [bit.name for bit in bits if f"{bit.name} = {bit.value}" not in text] == []


def test_the_guide_says_where_the_echo_goes_on_every_wire() -> None:
    text = GUIDE.read_text()
    for name, section in (("euclid", "register"), ("euclid_can", "signal")):
        place = load_site(CONFIG / f"{name}.yaml").gateway.read.aff_echo
        assert place is not None
        assert str(place.register_number if section == "register" else place.signal) in text
    echo = load_site(CONFIG / "euclid_canopen.yaml").gateway.read.aff_echo
    assert echo is not None
    assert str(echo.signal).partition(".")[2] in text


def test_the_guide_says_where_the_applied_corrections_go_on_every_wire() -> None:
    text = GUIDE.read_text()
    for name in ("euclid", "euclid_can", "euclid_canopen"):
        for shown in load_site(CONFIG / f"{name}.yaml").gateway.applied.values():
            place = str(shown.register_number if shown.signal is None else shown.signal)
            assert place.rpartition(".")[2] in text, place


@pytest.mark.parametrize("name", ["COMMISSIONING.md", "AFF_GATEWAY.st"])
def test_the_plc_programmer_is_told_of_the_counters_of_a_set(name: str) -> None:
    text = (GUIDE.parent / name).read_text()
    assert "Counter" in text
    if name == GUIDE.name:
        sent = cantools.database.load_file(CONFIG / "euclid.dbc").messages
        for message in sent:
            if "AFF" in message.senders and "Counter" in {s.name for s in message.signals}:
                assert message.name in text
