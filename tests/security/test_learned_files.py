"""Learned responses and shapes: what they are is part of what runs, and strangers' ones wait."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.link.messages import ConfigDiffers, Parameters
from aff_runtime.app.supervisor.response_ledger import NAME, ResponseLedger, learned_sentences
from aff_runtime.config.loader import load_recorded_site
from tests import quick_yaml
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until
from tests.security.learned_files import (
    REVISION_WORD,
    SIGNALS,
    SITE,
    CheckInProcess,
    House,
    checked,
    learned,
    response,
    site_in,
)

pytestmark = pytest.mark.processes


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return site_in(tmp_path)


# --- part of what runs ----------------------------------------------------------------------


def test_without_learned_files_the_revision_is_the_site_files_own(site: Path) -> None:
    parameters = checked(site)
    assert parameters.config_hash == parameters.site_hash
    assert parameters.learned == {}


def test_a_response_of_another_phase_is_another_revision_for_service_and_plc(site: Path) -> None:
    seen = []
    for turned_rad in (0.0, math.pi):
        learned(site).write_text(response("unwind", turned_rad))
        seen.append(checked(site))
    one, other = seen
    assert one.site_hash == other.site_hash
    assert one.config_hash != other.config_hash
    assert one.revision_word != other.revision_word
    digest = hashlib.sha256(learned(site).read_bytes()).hexdigest()
    assert other.learned == {"unwind": {"response": digest}}


def test_a_shape_that_the_service_starts_from_is_part_of_the_revision_too(site: Path) -> None:
    parameters = checked(site)
    hashes = {
        parameters.with_shapes(shapes).config_hash
        for shapes in ({}, {"unwind": "a"}, {"unwind": "b"}, {"swrap_follower": "a"})
    }
    assert len(hashes) == 4
    told = list(learned_sentences(parameters.with_shapes({"unwind": "a"}), ResponseLedger(str)))
    assert told[0] == f"unwind: no response, shape {hashlib.sha256(b'a').hexdigest()[:12]}"


# --- whose it is ----------------------------------------------------------------------------


def test_the_list_of_our_own_responses_is_private_and_outlives_the_service(site: Path) -> None:
    faults: list[str] = []
    path, text = learned(site), response("unwind")
    before = os.umask(0)
    try:
        ResponseLedger(faults.append).add(path, text)
    finally:
        os.umask(before)
    kept = path.parent / NAME
    assert kept.stat().st_mode & 0o777 == 0o600
    assert os.listdir(path.parent) == [NAME]
    assert ResponseLedger(faults.append).knows(path, text)
    assert not ResponseLedger(faults.append).knows(path, text + " ")
    assert not ResponseLedger(faults.append).knows(learned(site, "swrap_follower"), text)
    assert faults == []


def test_only_the_newest_probe_of_a_file_counts(site: Path) -> None:
    ledger = ResponseLedger(str)
    path, old, new = learned(site), response("unwind"), response("unwind", 0.1)
    ledger.add(path, old)
    ledger.add(path, new)
    assert ledger.knows(path, new)
    assert not ledger.knows(path, old)


def _open_to_others(kept: Path, good: str) -> None:
    kept.write_text(good)
    kept.chmod(0o620)


def _link(kept: Path, good: str) -> None:
    kept.with_name("elsewhere").write_text(good)
    kept.with_name("elsewhere").chmod(0o600)
    kept.symlink_to("elsewhere")


def _rubbish(kept: Path, good: str) -> None:
    kept.write_text("[" * 50_000)
    kept.chmod(0o600)


def _pipe(kept: Path, good: str) -> None:
    os.mkfifo(kept, 0o600)


def _foreign(kept: Path, good: str) -> None:
    if os.geteuid() != 0:
        pytest.skip("needs root to give a file away")
    kept.write_text(good)
    kept.chmod(0o600)
    os.chown(kept, 65534, 65534)


@pytest.mark.parametrize("spoil", [_open_to_others, _link, _rubbish, _pipe, _foreign])
def test_a_list_that_somebody_else_may_have_written_counts_for_nothing(
    site: Path, spoil: Callable[[Path, str], None]
) -> None:
    path, text = learned(site), response("unwind")
    good = json.dumps({path.name: hashlib.sha256(text.encode()).hexdigest()})
    spoil(path.parent / NAME, good)
    faults: list[str] = []
    ledger = ResponseLedger(faults.append)
    assert not ledger.knows(path, text)
    assert not ledger.knows(path, text)
    (fault,) = faults
    assert "every response there counts as brought from outside" in fault


# --- what waits, and what does not ----------------------------------------------------------


@pytest.fixture
def house(site: Path, monkeypatch: pytest.MonkeyPatch) -> House:
    learned(site).write_text(response("unwind"))
    return House(site, monkeypatch)


def test_a_response_exchanged_while_armed_waits_for_bypass_and_says_so(
    house: House, site: Path
) -> None:
    before = house.running
    learned(site).write_text(response("unwind", math.pi))
    after = hashlib.sha256(learned(site).read_bytes()).hexdigest()
    house.look()
    house.step()
    assert house.running == before
    assert not [m for m in house.sent if isinstance(m, Parameters)]
    (told,) = house.edits.differs
    assert f"{learned(site)}: response {before[:12]} -> {after[:12]}" in told
    assert "no probe of this service wrote it" in told
    assert "`aff-runtime bypass`" in told
    house.live = False
    house.step()
    assert house.running == after
    assert house.edits.differs == ()
    assert ("CONFIG_APPLIED", f"unwind: response {after[:12]} (brought from outside)") in [
        (name, text.partition(";")[0]) for name, text in house.said
    ]
    exchange = next(text for name, text in house.said if name == "EDIT")
    assert f"brought from outside; file of uid {os.geteuid()}" in exchange


def test_a_response_taken_away_while_armed_waits_too(house: House, site: Path) -> None:
    before = house.running
    learned(site).unlink()
    house.look()
    assert house.running == before
    assert "-> none" in house.edits.differs[0]


def test_the_former_file_put_back_ends_the_waiting(house: House, site: Path) -> None:
    good = learned(site).read_text()
    learned(site).write_text(response("unwind", math.pi))
    house.look()
    assert house.edits.differs
    learned(site).write_text(good)
    house.look()
    house.live = False
    house.step()
    assert house.edits.differs == ()
    assert not [m for m in house.sent if isinstance(m, Parameters)]


def test_an_edit_that_was_replaced_on_the_disk_is_not_applied_at_bypass(
    house: House, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good, before = learned(site).read_text(), house.running
    learned(site).write_text(response("unwind", math.pi))
    house.look()
    assert house.edits.differs
    learned(site).write_text(good)
    with monkeypatch.context() as slow:
        slow.setattr(CheckInProcess, "result", lambda *_: None)
        house.edits.look_again()
        house.live = False
        house.step()
    assert not [m for m in house.sent if isinstance(m, Parameters)]
    house.step()
    assert house.running == before
    assert house.edits.differs == ()


def test_what_our_own_probe_has_just_written_comes_in_at_once(house: House, site: Path) -> None:
    text = response("unwind", 0.05)
    house.probed.add(learned(site), text)
    learned(site).write_text(text)
    house.look()
    assert house.running == hashlib.sha256(text.encode()).hexdigest()
    assert house.edits.differs == ()
    assert any("(probed here)" in text for name, text in house.said if name == "CONFIG_APPLIED")


def test_numbers_that_a_probe_identified_are_no_edit_of_the_site_file(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = SITE.read_text().replace("settle_s: 6", "settle_s: 7")  # stands for a drive's number
    found = house.parameters.model_copy(update={"site": load_recorded_site(site, "site.yaml")})
    result = CheckResult(parameters=found, findings=())
    monkeypatch.setattr(CheckInProcess, "result", lambda self: result)
    house.look()
    (said,) = [text for name, text in house.said if name == "EDIT"]
    assert said.startswith("a probe identified actuators.unwind.blocks[0].settle_s: ")


def test_an_edit_of_the_site_file_does_not_carry_a_strangers_response_in(
    house: House, site: Path
) -> None:
    before, settled = house.running, house.parameters.site_hash
    learned(site).write_text(response("unwind", math.pi))
    site.write_text(site.read_text().replace("settle_s: 6", "settle_s: 9"))
    house.look()
    assert (house.running, house.parameters.site_hash) == (before, settled)
    house.live = False
    house.step()
    assert house.running != before
    assert house.parameters.site_hash != settled


# --- the whole service ----------------------------------------------------------------------


@pytest.fixture
def service(tmp_path: Path) -> Iterator[ServiceRun]:
    (tmp_path / "learned").mkdir()
    for actuator in SIGNALS:
        (tmp_path / "learned" / f"euclid_{actuator}.json").write_text(response(actuator))
    run = ServiceRun(tmp_path, cycle_ms=10)
    yield run
    run.close()


def exchange_while_armed(service: ServiceRun, text: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the status before and after; again when a pause of this machine ended the state."""
    file = service.folder / "learned" / "euclid_unwind.json"
    good = file.read_text()
    for _ in range(4):
        assert service.ask("arm")["state"] in ("ARMED", "ACTIVE")
        before = service.status()
        file.write_text(text)
        until(
            "the exchange is told",
            lambda: service.status()["config_differs"] or service.status()["state"] == "FAULT",
        )
        after = service.status()
        if after["state"] in ("ARMED", "ACTIVE") and after["config_differs"]:
            return before, after
        assert after["alarm"]["name"] in ("PLC_STALE", "OVERRUN"), after["alarm"]
        file.write_text(good)
        until("the good one is back", lambda: not service.status()["config_differs"])
    raise AssertionError("never undisturbed")


@pytest.mark.long  # quick: exchanged while armed, above
@pytest.mark.wire
def test_a_turned_response_does_not_reach_the_line_before_an_operators_bypass(
    service: ServiceRun,
) -> None:
    turned = response("unwind", math.pi)
    digest = hashlib.sha256(turned.encode()).hexdigest()
    running, waiting = exchange_while_armed(service, turned)
    assert waiting["config_hash"] == running["config_hash"]
    assert "no probe of this service wrote it" in waiting["config_differs"][0]
    word = int(running["config_hash"][-4:], 16)
    assert service.tell_plc("words")[REVISION_WORD] == word
    service.ask("bypass")
    until("the response is let in", lambda: not service.status()["config_differs"])
    status = service.status()
    assert status["config_hash"] not in (running["config_hash"], status["site_hash"])
    assert f"unwind: response {digest[:12]} (brought from outside)" in status["learned"]
    until(
        "the PLC sees it",
        lambda: service.tell_plc("words")[REVISION_WORD] == int(status["config_hash"][-4:], 16),
    )
    applied = [line for line in service.log.read_text().splitlines() if "CONFIG_APPLIED" in line]
    assert running["config_hash"][:12] in applied[0]
    assert status["config_hash"][:12] in applied[-1]
    assert f"unwind: response {digest[:12]}" in applied[-1]
    (folder,) = (service.folder / "runs").iterdir()
    about = quick_yaml.safe_load((folder / "run.yaml").read_text())
    assert about["config_hash"] == running["config_hash"]
    assert set(about["learned"]) == set(SIGNALS)
    assert len(about["learned"]["unwind"]["response"]) == 64
    assert about["started_by"].startswith("uid ")


# --- the site file of a running service -----------------------------------------------------


def _edit_gone(site: Path) -> None:
    site.unlink()


def _edit_folder(site: Path) -> None:
    site.unlink()
    site.mkdir()


def _edit_pipe(site: Path) -> None:
    site.unlink()
    os.mkfifo(site)


def _edit_link(site: Path) -> None:
    site.unlink()
    site.symlink_to("/etc/passwd")


def _edit_torn(site: Path) -> None:
    site.write_text(site.read_text()[:1000])


def _edit_empty(site: Path) -> None:
    site.write_text("")


def _edit_tagged(site: Path) -> None:
    site.write_text("!!python/object/apply:os.system ['true']\n")


def _edit_hostile(site: Path) -> None:
    site.write_text(
        site.read_text().replace("\n  name: ", '\n  name: "a\\nINFO OPERATOR: arm"  # ', 1)
    )


@pytest.mark.parametrize(
    "spoil",
    [
        _edit_gone,
        _edit_folder,
        _edit_pipe,
        _edit_link,
        _edit_torn,
        _edit_empty,
        _edit_tagged,
        _edit_hostile,
    ],
)
@pytest.mark.parametrize("live", [True, False])
def test_whatever_becomes_of_the_site_file_what_runs_goes_on_and_is_told(
    house: House, site: Path, spoil: Callable[[Path], None], live: bool
) -> None:
    house.live = live
    before = house.parameters
    good = site.read_text()
    spoil(site)
    house.look()
    assert house.parameters is before
    assert house.sent == [ConfigDiffers()]
    assert house.edits.differs
    for told in house.edits.differs:
        assert told.isprintable()
        assert told.startswith(f"{site}:")
    if not site.is_file() or site.is_symlink():
        site.rmdir() if site.is_dir() else site.unlink(missing_ok=True)
    site.write_text(good)
    house.look()
    assert house.edits.differs == ()
    assert house.parameters is before
