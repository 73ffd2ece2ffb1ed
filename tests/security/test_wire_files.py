"""A DBC or EDS file says where each value lies, its scale and sign: it is part of what runs."""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.response_exchange import exchanged_wire_files
from aff_runtime.app.supervisor.response_ledger import ResponseLedger, learned_sentences
from tests.security.learned_files import CheckInProcess

CONFIG = Path(__file__).parents[2] / "config"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("euclid_can.yaml", "euclid.dbc", "euclid_canopen.yaml"):
        shutil.copy(CONFIG / name, tmp_path / name)
    for name in ("euclid_drive.eds", "euclid_line.eds"):
        shutil.copy(CONFIG / name, tmp_path / name)
    return tmp_path


def checked(site: Path) -> ParameterRecord:
    return check_result(site).checked()


def turn_tension_round(dbc: Path) -> None:
    """Change the sign of the signal that the law closes its loop over."""
    text = dbc.read_text(encoding="latin-1")
    turned = re.sub(r"(SG_ UnwindTension [^(]*\()0\.001,", r"\g<1>-0.001,", text)
    assert turned != text
    dbc.write_text(turned, encoding="latin-1")


def test_a_dbc_with_another_sign_is_another_revision_for_service_and_plc(folder: Path) -> None:
    site, dbc = folder / "euclid_can.yaml", folder / "euclid.dbc"
    one = checked(site)
    turn_tension_round(dbc)
    other = checked(site)
    assert one.site_hash == other.site_hash
    assert one.config_hash != other.config_hash
    assert one.revision_word != other.revision_word
    assert other.with_shapes({}).config_hash == other.config_hash
    digest = hashlib.sha256(dbc.read_bytes()).hexdigest()
    words = list(learned_sentences(other, ResponseLedger(lambda _: None)))
    assert f"euclid.dbc: describes the wire, {digest[:12]}" in words


def test_every_eds_file_is_in_the_revision(folder: Path) -> None:
    site = folder / "euclid_canopen.yaml"
    seen = {checked(site).config_hash}
    for name in ("euclid_drive.eds", "euclid_line.eds"):
        with (folder / name).open("a") as file:
            file.write("; another one\n")
        seen.add(checked(site).config_hash)
    assert len(seen) == 3


class House:
    """The supervisor's children as an edit session sees them."""

    def __init__(self, site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(edit_session, "Validation", CheckInProcess)
        self.parameters = checked(site)
        self.said: list[tuple[str, str]] = []
        self.starts: list[str] = []
        self.live = True
        self.control = SimpleNamespace(link=SimpleNamespace(send=lambda _: True))
        self.probed = ResponseLedger(lambda _: None)
        found = CheckResult(parameters=self.parameters)
        self.edits = EditSession(self, None, site, found)  # type: ignore[arg-type]

    def note(self, name: str, text: str) -> None:
        self.said.append((name, text))

    def is_live(self) -> bool:
        return self.live

    def revised(self, parameters: ParameterRecord) -> ParameterRecord:
        return parameters.with_shapes({})

    def stop(self) -> None:
        self.starts.append("stop")

    def start(self) -> None:
        self.starts.append(self.parameters.config_hash)


def test_a_dbc_exchanged_while_armed_is_told_and_waits_for_bypass(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    house = House(folder / "euclid_can.yaml", monkeypatch)
    before = house.parameters.config_hash
    turn_tension_round(folder / "euclid.dbc")
    for _ in range(4):  # seen, settled, checked
        house.edits.step()
    (told,) = house.edits.differs
    assert re.search(r"euclid.dbc: describes the wire, \w{12} -> \w{12}: may not change", told)
    assert house.parameters.config_hash == before
    (edit,) = {text for name, text in house.said if name == "EDIT"}
    assert "euclid.dbc: describes the wire" in edit
    assert "file of uid" in edit
    house.live = False
    house.edits.step()
    assert house.edits.differs == ()
    assert house.starts == ["stop", house.parameters.config_hash]
    assert house.parameters.config_hash != before


def test_the_same_file_saved_again_is_no_exchange(folder: Path) -> None:
    parameters = checked(folder / "euclid_can.yaml")
    assert exchanged_wire_files(parameters, parameters) == []
