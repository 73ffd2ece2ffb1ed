"""Learned responses and shapes: what they are is part of what runs, and strangers' ones wait."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from aff_runtime.app.check.validate import verdict
from aff_runtime.app.link.messages import ConfigDiffers, Message, Parameters, Reply
from aff_runtime.app.supervisor import edit_session
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.response_ledger import NAME, ResponseLedger, learned_words
from aff_runtime.app.supervisor.validation import Verdict
from aff_runtime.app.wiring.assemble import revision_of
from aff_runtime.app.wiring.parameter_record import with_shapes
from aff_runtime.core.response import Provenance, Response, ResponsePoint
from tests.aff_runtime.app.service_run import ServiceRun
from tests.doubles.virtual_clock import VirtualClock
from tests.processes import until

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid_blocks.yaml"
SIGNALS = {"unwind": "unwind_tension_N", "swrap_follower": "pullroll_tension_N"}
GAIN = 2000.0
REVISION_WORD = 7  # of the write block


def response(actuator: str, turned_rad: float = 0.0) -> str:
    """A good measurement, its phases turned: by 180 degrees it drives ripple up."""
    points = [
        ResponsePoint(
            frequency_Hz=f,
            gain=GAIN,
            phase_rad=math.pi - math.tau * f * 0.030 + turned_rad,
            relative_error=0.01,
            coherence=1.0,
        )
        for f in (0.3, 0.6, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0)
    ]
    about = Provenance(actuator=actuator, signal=SIGNALS[actuator])
    return Response(points=points, delay_s=0.030, provenance=about).to_json() + "\n"


def checked(site: Path) -> dict[str, Any]:
    said = verdict(site)
    assert said["record"] is not None, said["findings"]
    return dict(said["record"])


@pytest.fixture
def site(tmp_path: Path) -> Path:
    path = tmp_path / "site.yaml"
    path.write_text(SITE.read_text())
    (tmp_path / "learned").mkdir()
    return path


def learned(site: Path, actuator: str = "unwind") -> Path:
    return site.parent / "learned" / f"euclid_{actuator}.json"


# --- part of what runs ----------------------------------------------------------------------


def test_without_learned_files_the_revision_is_the_site_files_own(site: Path) -> None:
    record = checked(site)
    assert record["config_hash"] == record["site_hash"]
    assert record["learned"] == {}


def test_a_response_of_another_phase_is_another_revision_for_service_and_plc(site: Path) -> None:
    seen = []
    for turned_rad in (0.0, math.pi):
        learned(site).write_text(response("unwind", turned_rad))
        seen.append(checked(site))
    one, other = seen
    assert one["site_hash"] == other["site_hash"]
    assert one["config_hash"] != other["config_hash"]
    assert revision_of(one) != revision_of(other)
    digest = hashlib.sha256(learned(site).read_bytes()).hexdigest()
    assert other["learned"] == {"unwind": {"response": digest}}


def test_a_shape_that_the_service_starts_from_is_part_of_the_revision_too(site: Path) -> None:
    record = checked(site)
    hashes = {
        with_shapes(record, shapes)["config_hash"]
        for shapes in ({}, {"unwind": "a"}, {"unwind": "b"}, {"swrap_follower": "a"})
    }
    assert len(hashes) == 4
    told = list(learned_words(with_shapes(record, {"unwind": "a"}), ResponseLedger(str)))
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


class House:
    """The service around an edit: live or not, and what reaches the control process."""

    def __init__(self, site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.live = True
        self.said: list[tuple[str, str]] = []
        self.sent: list[Message] = []
        self.record = checked(site)
        self.probed = ResponseLedger(str)
        self.control = SimpleNamespace(link=SimpleNamespace(send=self._send))
        self._pending = Pending(VirtualClock())
        monkeypatch.setattr(edit_session, "Validation", _Check)
        self.edits = EditSession(
            self,
            self._pending,
            SimpleNamespace(site=site, state_directory=site.parent),
            Verdict(record=self.record, findings=()),
        )

    def note(self, name: str, text: str) -> None:
        self.said.append((name, text))

    def is_live(self) -> bool:
        return self.live

    def revised(self, record: Mapping[str, Any]) -> dict[str, Any]:
        return with_shapes(record, {})

    def revision_words(self) -> str:
        return "; ".join(learned_words(self.record, self.probed))

    def _send(self, message: Message) -> bool:
        self.sent.append(message)
        return True

    def look(self) -> None:
        """See the file, as after a change that has settled; the control process agrees."""
        self.edits.look_again()
        self.step()

    def step(self) -> None:
        self.edits.step()
        for message in self.sent:
            if isinstance(message, Parameters):
                self._pending.resolve(Reply(id=message.id, ok=True))

    @property
    def running(self) -> str:
        return str(self.record["learned"].get("unwind", {}).get("response", "none"))


class _Check:
    """The check of a file, in this process."""

    def __init__(self, site: Path, *_: object) -> None:
        self._site = site

    def verdict(self, **_: object) -> Verdict:
        said = verdict(self._site)
        return Verdict(record=said["record"], findings=tuple(said["findings"]))

    def abandon(self) -> None:
        pass


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


def test_what_our_own_probe_has_just_written_comes_in_at_once(house: House, site: Path) -> None:
    text = response("unwind", 0.05)
    house.probed.add(learned(site), text)
    learned(site).write_text(text)
    house.look()
    assert house.running == hashlib.sha256(text.encode()).hexdigest()
    assert house.edits.differs == ()
    assert any("(probed here)" in text for name, text in house.said if name == "CONFIG_APPLIED")


def test_an_edit_of_the_site_file_does_not_carry_a_strangers_response_in(
    house: House, site: Path
) -> None:
    before, settled = house.running, house.record["site_hash"]
    learned(site).write_text(response("unwind", math.pi))
    site.write_text(site.read_text().replace("settle_s: 6", "settle_s: 9"))
    house.look()
    assert (house.running, house.record["site_hash"]) == (before, settled)
    house.live = False
    house.step()
    assert house.running != before
    assert house.record["site_hash"] != settled


# --- the whole service ----------------------------------------------------------------------


@pytest.fixture
def service(tmp_path: Path) -> Iterator[ServiceRun]:
    (tmp_path / "learned").mkdir()
    for actuator in SIGNALS:
        (tmp_path / "learned" / f"euclid_{actuator}.json").write_text(response(actuator))
    run = ServiceRun(tmp_path)
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
    about = yaml.safe_load((folder / "run.yaml").read_text())
    assert about["config_hash"] == running["config_hash"]
    assert set(about["learned"]) == set(SIGNALS)
    assert len(about["learned"]["unwind"]["response"]) == 64
    assert about["started_by"].startswith("uid ")


# --- files that are none --------------------------------------------------------------------

GOOD = json.loads(response("unwind"))


def spoilt(**changes: Any) -> bytes:
    return json.dumps({**GOOD, **changes}).encode()


def pointed(**changes: Any) -> bytes:
    first, *others = GOOD["points"]
    return spoilt(points=[{**first, **changes}, *others])


RESPONSES = {
    "empty": b"",
    "blank": b"\n",
    "brackets": b"[" * 100_000,
    "objects": b'{"a":' * 100_000,
    "another format": spoilt(format="x"),
    "a format that is a list": spoilt(format=[[[1]]]),
    "no points": spoilt(points=[]),
    "points that are text": spoilt(points="unwind"),
    "NaN": pointed(gain=math.nan),
    "infinity": pointed(phase_rad=math.inf),
    "a gain below 0": pointed(gain=-1.0),
    "a gain of a number too long": spoilt().replace(b"2000.0", b"9" * 5000, 1),
    "a coherence of 2": pointed(coherence=2.0),
    "an unknown key of a point": pointed(extra=1),
    "an unknown key of the provenance": spoilt(
        provenance={**GOOD["provenance"], "__class__": "x"}
    ),
    "a delay that is text": spoilt(delay_s="soon"),
    "a newline in a name": spoilt(
        provenance={**GOOD["provenance"], "actuator": "unwind\nINFO OPERATOR: arm"}
    ),
    "bytes that are no text": b"\xff\xfe\x00",
    "a megabyte of provenance": spoilt(
        provenance={**GOOD["provenance"], "measured_at": "x" * 1_000_000}
    ),
    "five megabytes": b" " * 5_000_000,
}


@pytest.mark.parametrize("raw", RESPONSES.values(), ids=RESPONSES.keys())
def test_a_response_file_that_is_none_is_refused_in_one_sentence(site: Path, raw: bytes) -> None:
    learned(site).write_bytes(raw)
    said = verdict(site)
    assert said["record"] is None
    (finding,) = said["findings"]
    assert finding.isprintable()
    assert finding.startswith(f"{site}:")
    assert len(finding) < 600


@pytest.mark.parametrize("kind", ["pipe", "folder", "device", "link to a device", "loop"])
def test_what_is_no_file_in_place_of_a_response_is_refused_at_once(site: Path, kind: str) -> None:
    path = learned(site)
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "loop":
        path.symlink_to(path.name)
    else:
        path.symlink_to("/dev/zero")
    said = verdict(site)
    assert said["record"] is None
    (finding,) = said["findings"]
    assert ("/dev/zero" if "device" in kind else str(path)) in finding


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
    before = house.record
    good = site.read_text()
    spoil(site)
    house.look()
    assert house.record is before
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
    assert house.record is before
