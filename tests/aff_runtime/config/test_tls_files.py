"""TLS files are looked at before a service starts with them; openssl makes and dates them."""

from __future__ import annotations

import os
import shutil
import subprocess
from datetime import UTC, datetime
from pathlib import Path

import pytest

from aff_runtime.cli.main import main
from aff_runtime.config.check import check_site
from aff_runtime.config.loader import load_site
from aff_runtime.config.tls_files import issues
from aff_runtime.config.x509 import CERTIFICATE, pem_blocks, validity
from tests.aff_runtime.config.shipped import EUCLID
from tests.aff_runtime.fieldbus.modbus.test_tls_wire import make_certificate

pytestmark = pytest.mark.skipif(
    shutil.which("openssl") is None, reason="openssl makes the certificates"
)
TLS = "{ ca: plc.pem, certificate: aff.pem, private_key: aff.key }"
DAY_S = 86_400.0


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tls")
    for name in ("plc", "aff", "other"):
        make_certificate(folder, name)
    subprocess.run(
        [
            "openssl",
            "pkey",
            "-in",
            folder / "aff.key",
            "-aes256",
            "-passout",
            "pass:secret",
            "-out",
            folder / "locked.key",
        ],
        check=True,
        capture_output=True,
    )
    (folder / "empty.pem").write_text("nothing\n")
    return folder


def site(made: Path, tls: str = TLS) -> Path:
    text = EUCLID.read_text()
    assert text.count("    port: 5020") == 1
    path = made / "site.yaml"
    path.write_text(text.replace("    port: 5020", f"    port: 5020\n    tls: {tls}"))
    return path


def of_openssl(certificate: Path) -> list[datetime]:
    said = subprocess.run(
        ["openssl", "x509", "-noout", "-startdate", "-enddate", "-in", certificate],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return [
        datetime.strptime(line.partition("=")[2], "%b %d %H:%M:%S %Y GMT").replace(tzinfo=UTC)
        for line in said.splitlines()
    ]


def test_files_that_fit_pass_without_a_word(made: Path) -> None:
    report = check_site(site(made))
    assert report.ok
    assert not [w for w in report.warnings if "modbus_tcp" in w.path]


@pytest.mark.parametrize(
    ("tls", "key", "said"),
    [
        (TLS.replace("plc.pem", "gone.pem"), "ca", "gone.pem cannot be read (No such file"),
        (TLS.replace("aff.key", "gone.key"), "private_key", "gone.key cannot be read"),
        (TLS.replace("aff.key", "."), "private_key", "cannot be read (Is a directory)"),
        (TLS.replace("plc.pem", "empty.pem"), "ca", "empty.pem holds no PEM certificate"),
        (TLS.replace("aff.pem", "empty.pem"), "certificate", "empty.pem holds no PEM"),
        (TLS.replace("aff.key", "empty.pem"), "private_key", "empty.pem holds no PEM key"),
        (
            TLS.replace("aff.key", "other.key"),
            "private_key",
            "the key in other.key does not belong to the certificate in aff.pem.",
        ),
        (TLS.replace("aff.key", "locked.key"), "private_key", "the key is encrypted"),
        ("{ ca: plc.pem, certificate: aff.pem }", "certificate", "aff.pem holds no PEM key"),
        ("{ ca: plc.pem, private_key: aff.key }", "private_key", "a key without certificate"),
    ],
)
def test_what_cannot_work_is_refused_at_its_place(
    made: Path, tls: str, key: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = site(made, tls)
    row = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if "tls:" in line)
    assert main(["check", str(path)]) == 2
    shown = capsys.readouterr().err
    assert f"{path}:{row}:" in shown
    assert f"gateway.modbus_tcp.tls.{key}: " in shown
    assert said in shown
    assert "Traceback" not in shown


def test_the_dates_are_those_that_openssl_reads(made: Path) -> None:
    (der,) = pem_blocks((made / "aff.pem").read_text(), CERTIFICATE)
    assert list(validity(der)) == of_openssl(made / "aff.pem")


def test_a_certificate_that_has_expired_is_said_and_only_warns(made: Path) -> None:
    loaded = load_site(site(made))
    last = max(of_openssl(made / "aff.pem"))
    before, after = last.timestamp() - 31 * DAY_S, last.timestamp() + DAY_S
    assert not list(issues(loaded, made, before))
    late = list(issues(loaded, made, after))
    assert [issue.path[-1] for issue in late] == ["ca", "certificate"]
    assert all(issue.warning for issue in late)
    assert f"a certificate in aff.pem expired on {last:%Y-%m-%d}" in late[1].text


def test_a_machine_whose_clock_is_behind_is_told_its_date(made: Path) -> None:
    first = min(of_openssl(made / "aff.pem"))
    (early, _) = issues(load_site(site(made)), made, first.timestamp() - 10 * DAY_S)
    assert f"is in force from {first:%Y-%m-%d} on" in early.text
    assert "this machine's clock: " in early.text


@pytest.mark.parametrize("key", ["ca", "certificate", "private_key"])
def test_a_pipe_in_the_place_of_a_certificate_is_refused_and_not_waited_for(
    made: Path, key: str
) -> None:
    pipe = made / "pipe"
    if not pipe.exists():
        os.mkfifo(pipe)
    tls = {"ca": "plc.pem", "certificate": "aff.pem", "private_key": "aff.key", key: "pipe"}
    report = check_site(site(made, f"{{ {', '.join(f'{k}: {v}' for k, v in tls.items())} }}"))
    assert not report.ok
    assert any("pipe is not a file" in line for line in report.lines())
