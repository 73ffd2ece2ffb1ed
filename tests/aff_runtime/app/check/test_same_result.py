"""``aff-runtime check`` and the service say the same of a site file and its responses."""

from __future__ import annotations

import errno
import json
import os
from pathlib import Path

import pytest

from aff_runtime.app.check.validate import check_result
from aff_runtime.cli.main import main
from aff_runtime.config import learned_responses
from tests.security.learned_files import learned, response, site_in
from tests.security.test_response_files import RESPONSES

OF_ANOTHER = response("swrap_follower").encode()


def command(site: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, list[str]]:
    """Return exit code and lines of ``aff-runtime check --brief``, of both streams."""
    code = main(["check", "--brief", str(site)])
    said = capsys.readouterr()
    return code, (said.out + said.err).splitlines()


@pytest.mark.parametrize("raw", [*RESPONSES.values(), OF_ANOTHER], ids=[*RESPONSES, "another's"])
def test_a_response_with_which_the_service_does_not_start_is_an_error_of_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], raw: bytes
) -> None:
    site = site_in(tmp_path)
    learned(site).write_bytes(raw)
    (finding,) = check_result(site).findings
    code, lines = command(site, capsys)
    assert code == 2
    assert f"error    {finding}" in lines
    assert "refused, 1 error" in lines[-1]


@pytest.mark.parametrize(("cycle_s", "counts"), [(0.005, True), (0.010, False)])
def test_a_response_of_another_cycle_is_a_warning_of_both_and_its_drive_is_not_used(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], cycle_s: float, counts: bool
) -> None:
    site = site_in(tmp_path)  # of 5 ms
    file = json.loads(response("unwind"))
    file["provenance"]["cycle_s"] = cycle_s
    learned(site).write_text(json.dumps(file))
    result = check_result(site)
    assert (list(result.checked().responses) == ["unwind"]) is counts
    said = [text for text in result.findings if "another cycle_ms" in text]
    assert len(said) == (0 if counts else 1)
    code, lines = command(site, capsys)
    assert code == 0
    assert [line for line in lines if "another cycle_ms" in line] == [
        f"warning  {t}" for t in said
    ]


def test_what_does_not_pass_to_the_control_process_is_an_error_of_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = site_in(tmp_path)
    file = json.loads(response("unwind"))
    first = file["points"][0]
    file["points"] = [{**first, "frequency_Hz": 1.0 + k} for k in range(3000)]
    learned(site).write_text(json.dumps(file))
    code, lines = command(site, capsys)
    assert code == 2
    assert any("kB pass to the control process" in line for line in lines)


def test_a_name_of_a_plc_is_asked_of_nobody(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = site_in(tmp_path)
    site.write_text(site.read_text().replace("host: 127.0.0.1", "host: no.such.host.invalid"))
    assert check_result(site).parameters is None
    assert command(site, capsys)[0] == 0


def test_a_response_that_only_the_service_may_read_is_said_with_how_to_ask_as_its_user(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def closed(path: Path, *_: object) -> bytes:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    site = site_in(tmp_path)
    monkeypatch.setattr(learned_responses, "read_plain", closed)  # root may read everything
    code, lines = command(site, capsys)
    assert code == 0
    said = [line for line in lines if "is not checked" in line]
    assert len(said) == 2
    assert all(line.startswith("warning  ") and "Permission denied" in line for line in said)
    assert all(f"sudo -u aff-runtime aff-runtime check {site}" in line for line in said)
    assert check_result(site).parameters is None  # of the service's own user it is an error
