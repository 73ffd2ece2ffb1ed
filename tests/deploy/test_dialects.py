"""The vendors' variants are made from the block, and read back they decide what it decides."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

pytest.importorskip("blark", reason="blark (the Structured Text parser) is not installed")

from releasing.dialects import DIALECTS, SOURCE, read_block
from tests.deploy import test_aff_gateway_st as cases
from tests.deploy.st_machine import StMachine, parsed

BLOCK = read_block(SOURCE.read_text())
NEW = "tests.deploy.test_aff_gateway_st.StMachine"
CASES = (
    cases.test_nothing_counts_before_a_heartbeat_moved_and_a_state_without_active_was_seen,
    cases.test_a_dead_heartbeat_trips_after_the_watchdog_and_is_zero_after_the_fade,
    lambda: cases.test_without_a_scan_time_nothing_counts_and_the_refusal_says_so(0.0),
    cases.test_what_is_shown_as_applied_is_what_is_left_after_limit_and_fade,
    cases.test_a_refusal_takes_the_enable_request_away_until_the_runtime_is_disarmed,
    cases.test_the_plc_can_acknowledge_a_refusal_by_an_edge_of_reset,
    cases.test_our_heartbeat_wraps_without_an_overflow,
    cases.test_the_watchdog_s_trips_stay_at_the_end_of_their_range,
    lambda: cases.test_a_second_master_takes_the_correction_to_zero(0),
    lambda: cases.test_a_heartbeat_may_step_by_64_and_wrap(65_500),
    lambda: cases.test_block_and_simulated_plc_agree_on_random_runs(1),
)


class LogixMachine(StMachine):
    """The add-on instruction by its vendor's rules: DINT, numbers for BOOL, no conversions.

    A REAL that is stored in an integer is rounded to the nearest, a half to the even one.
    """

    def __init__(self, _path: Path) -> None:
        root = ElementTree.parse(SOURCE.with_suffix(".L5X")).getroot()
        tags = [*root.iter("Parameter"), *root.iter("LocalTag")]
        tags = [tag for tag in tags if tag.get("Name") not in {"EnableIn", "EnableOut"}]
        self._body = self._routine(root, "Logic")
        self._prescan = self._routine(root, "Prescan")
        (made,) = root.iter("AddOnInstructionDefinition")
        self._rung_false = (
            self._routine(root, "EnableInFalse")
            if made.get("ExecuteEnableInFalse") == "true"
            else []
        )
        self.types = {tag.attrib["Name"]: tag.attrib["DataType"] for tag in tags}
        self.inputs = {tag.attrib["Name"] for tag in tags if tag.get("Usage") == "Input"}
        self.v: dict[str, Any] = dict.fromkeys(self.types, 0)
        for tag in tags:
            self._store(tag.attrib["Name"], float(tag.findtext("DefaultData") or 0))

    @staticmethod
    def _routine(root: ElementTree.Element, name: str) -> Any:
        (routine,) = (one for one in root.iter("Routine") if one.get("Name") == name)
        text = "\n".join(line.text or "" for line in routine.iter("Line"))
        return parsed(f"FUNCTION_BLOCK One\n{text}\nEND_FUNCTION_BLOCK\n").body.statements

    def start(self) -> None:
        """Run what the controller runs when it begins."""
        self._run(self._prescan)

    def call_on_a_false_rung(self) -> dict[str, Any]:
        """Scan with EnableIn 0: the logic is not run, tags stay but for EnableInFalse."""
        self._run(self._rung_false)
        return self.v

    def _store(self, name: str, value: Any) -> None:
        kind = self.types[name]
        if kind == "BOOL":
            assert value in (0, 1)
            super()._store(name, bool(value))
        elif kind == "DINT":
            assert -(2**31) <= value < 2**31
            self.v[name] = round(value)
        else:
            super()._store(name, round(value) if kind == "INT" else float(value))


def scl_machine(tmp_path: Path) -> Callable[[Path], StMachine]:
    """Return the source of SCL with the marks of its names and its BEGIN taken out."""
    text = SOURCE.with_suffix(".scl").read_text()
    head, body = text.partition("FUNCTION_BLOCK")[2].split("BEGIN\n")
    rows = ["FUNCTION_BLOCK AFF_GATEWAY"]
    for row in head.partition("VERSION : 0.1\n")[2].splitlines():
        declared = row.partition("//")[0].strip()
        name, colon, rest = declared.partition(" : ")
        kind, *initial = rest.split(maxsplit=1)[:2] if colon else ("",)
        rows.append(f"{name} : {' '.join([kind.upper(), *initial])}" if colon else declared)
    plain = tmp_path / "plain.st"
    plain.write_text("\n".join(rows) + "\n" + re.sub(r"(?<!16)#", "", body))
    return lambda _path: StMachine(plain)


@pytest.fixture(params=[pytest.param("SCL", marks=pytest.mark.long), "Logix"])
def variant(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(NEW, scl_machine(tmp_path) if request.param == "SCL" else LogixMachine)


@pytest.mark.parametrize("suffix", DIALECTS)
def test_the_variants_are_what_the_source_makes_and_say_that_no_compiler_saw_them(
    suffix: str,
) -> None:
    made = DIALECTS[suffix](BLOCK)
    assert SOURCE.with_suffix(suffix).read_text() == made, "run: make plc"
    assert "UNTESTED" in made


@pytest.mark.parametrize("number", range(len(CASES)))
def test_a_variant_read_back_decides_what_the_simulated_plc_decides(
    variant: None, number: int
) -> None:
    CASES[number]()


def test_a_logix_controller_that_starts_forgets_what_its_tags_retained() -> None:
    machine = LogixMachine(SOURCE)
    fresh = {name: value for name, value in machine.v.items() if name not in machine.inputs}
    for name in fresh:
        machine._store(name, 1)
    machine.start()
    assert {name: machine.v[name] for name in fresh} == fresh
    assert machine.v["NeedsRearm"] is True


def test_a_logix_rung_that_goes_false_takes_the_correction_away_until_aff_begins_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(NEW, LogixMachine)
    block = cases.Both().accepted().block
    out = block.call_on_a_false_rung()
    added = ("Correction1", "Correction2", "Applied1", "Applied2")
    assert {name: out[name] for name in added} == dict.fromkeys(added, 0)
    assert (out["EnableRequest"], out["Accepted"]) == (False, False)
    # the rung is true again while AFF still says ACTIVE: no scan without it has come
    block.call(AffHeartbeat=4)
    refused = block.call(AffHeartbeat=5)
    assert (refused["Refusal"], refused["Correction1"]) == (3, 0.0)


def test_a_text_that_declares_in_another_form_is_refused() -> None:
    text = SOURCE.read_text().replace("    Known : BOOL;\n", "    Known, Heard2 : BOOL;\n")
    with pytest.raises(ValueError, match="a line of VAR"):
        read_block(text)
    with pytest.raises(ValueError, match="no FUNCTION_BLOCK"):
        read_block("PROGRAM One\nEND_PROGRAM\n")
