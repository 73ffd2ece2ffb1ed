"""Status bits where the PLC has them: places, polarity, and what is said of a wrong one."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.app.wiring.site_to_wire import register_map
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Status
from aff_runtime.config.loader import load_site
from aff_runtime.config.registers import read_rows
from tests.aff_runtime.config.shipped import edited

STATUS = "    status: { register: 1 }\n"
NEEDED = "LINE_RUN: { bit: 4 }, TENSION_VALID: { bit: 5 }, AFF_ENABLE_REQUEST: { bit: 0 }"
OWN = f"{NEEDED}, WEB_INTACT: {{ bit: 3, inverted: true }}, ESTOP_OK: {{ register: 20, bit: 7 }}"


def with_bits(folder: Path, bits: str) -> Path:
    return edited(folder, (STATUS, f"    status: {{ register: 1, bits: {{ {bits} }} }}\n"))


def test_bits_have_their_place_their_word_and_their_polarity(tmp_path: Path) -> None:
    words = register_map(load_site(with_bits(tmp_path, OWN)))
    places = {
        place.means: (place.address, place.bit, place.inverted) for place in words.status_places
    }
    assert places == {
        Status.LINE_RUN: (1, 4, False),
        Status.TENSION_VALID: (1, 5, False),
        Status.AFF_ENABLE_REQUEST: (1, 0, False),
        Status.WEB_INTACT: (1, 3, True),
        Status.ESTOP_OK: (20, 7, False),
    }
    assert (words.read_start, words.read_count) == (0, 21)  # one block, with the word of ESTOP_OK


def test_without_bits_the_word_keeps_its_order(tmp_path: Path) -> None:
    assert register_map(load_site(edited(tmp_path))).status_places == ()


def test_a_word_with_bits_alone_is_a_row_once(tmp_path: Path) -> None:
    bits = OWN.replace("LINE_RUN: { bit: 4 }", "LINE_RUN: { register: 20, bit: 4 }")
    rows = [row.address for row in read_rows(load_site(with_bits(tmp_path, bits)))]
    assert rows.count(20) == rows.count(1) == 1


HERE = [
    (("LINE_RUN", "LINE_RUM"), "bits.LINE_RUM: unknown key. Did you mean LINE_RUN?"),
    (("bit: 4", "bit: 16"), "bits.LINE_RUN.bit: 16 is too large. Allowed: 0 to 15."),
    (("bit: 5", "bit: 4"), "TENSION_VALID.bit: bit 4 of wire address 1 is LINE_RUN already."),
    (("{ bit: 4 }", "4"), 'bits.LINE_RUN: "4" stands where a section is expected.'),
    (("AFF_ENABLE_REQUEST: { bit: 0 }, ", ""), "bits: AFF_ENABLE_REQUEST has no place, so"),
]
ELSEWHERE = [
    (("register: 20", "register: 2"), "wire address 2 is taken by "),
    (("register: 20", "register: 104"), "wire address 104 is taken by "),
    (("register: 20", "register: 126"), "127 words"),
    (("LINE_RUN: { bit: 4 }, ", ""), "permissives.need[0]: LINE_RUN has no place in "),
]


@pytest.mark.parametrize(("edit", "said"), HERE + ELSEWHERE)
def test_what_is_wrong_is_said_with_its_line(
    tmp_path: Path, edit: tuple[str, str], said: str
) -> None:
    path = with_bits(tmp_path, OWN.replace(*edit))
    with pytest.raises(ConfigError) as error:
        load_site(path)
    assert said in str(error.value)
    line = 1 + next(
        n for n, text in enumerate(path.read_text().splitlines()) if " bits: {" in text
    )
    if (edit, said) in HERE:
        assert f"{path}:{line}:" in str(error.value)


def test_on_can_the_word_keeps_our_order(folder: Path) -> None:
    path = folder / "euclid_can.yaml"
    text = path.read_text()
    begin = text.index("    status: {")
    end = text.index("\n", begin)
    line = text[begin:end].replace(" }", ", bits: { LINE_RUN: { bit: 0 } } }")
    path.write_text(text[:begin] + line + text[end:])
    with pytest.raises(ConfigError, match=r"status\.bits: is for Modbus"):
        load_site(path)
