"""TLS to the PLC: who is spoken to, who never is, and what the check says of the files before."""

from __future__ import annotations

import contextlib
import shutil
import socket
import ssl
import threading
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.signals import Outcome
from aff_runtime.config.check import check_site
from aff_runtime.config.loader import load_site
from aff_runtime.config.tls_files import issues
from aff_runtime.config.x509 import REVOCATION_LIST, list_dates, list_issuer, pem_blocks, subject
from aff_runtime.fieldbus.modbus.connections import modbus
from aff_runtime.fieldbus.modbus.tls_wire import TlsWire, client_context
from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.registers import Registers
from tests.aff_runtime.config.shipped import EUCLID
from tests.aff_runtime.fieldbus.euclid_map import euclid_map
from tests.security.certificates import Authority
from tests.sim_plant.servers.fake_line import default_map

pytestmark = [
    pytest.mark.wire,
    pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificates"),
]
DAY_S = 86_400.0
SHOWN: dict[str, dict[str, Any]] = {
    "good": {},
    "by address": {"names": "IP:127.0.0.1"},
    "expired": {"end": "20250101000000Z"},
    "not yet in force": {"begin": "20800101000000Z"},
    "of another host": {"names": "DNS:plc2", "subject": "plc2"},
    "of the name in CN alone": {"names": ""},
    "CN right, name wrong": {"names": "DNS:plc2"},
    "for clients alone": {"usage": "clientAuth"},
    "signed with SHA-1": {"digest": "sha1"},
    "a key of 1024 bits": {"key": ("rsa:1024",)},
    "taken back": {},
}


@pytest.fixture(scope="module")
def ours(tmp_path_factory: pytest.TempPathFactory) -> Authority:
    """The plant's authority with every certificate that a PLC may show."""
    authority = Authority(tmp_path_factory.mktemp("tls"))
    for kind, properties in SHOWN.items():
        authority.sign(slug(kind), **properties)
    authority.revoke(made(authority, "taken back"))
    authority.revocation_list("crl")
    return authority


def slug(kind: str) -> str:
    return kind.replace(" ", "-").replace(",", "").lower()


def made(ours: Authority, kind: str) -> Path:
    return ours.folder / f"{slug(kind)}.pem"


def plain(raw: socket.socket) -> socket.socket:
    return raw


def silent(raw: socket.socket) -> socket.socket:
    raw.recv(1)
    raise OSError("says nothing more")


class Plc:
    """A PLC that speaks TLS, or does something else in its place.

    Parameters
    ----------
    certificate : what it shows, with its key beside it; None: ``instead`` says what it does.
    ciphers, newest : all that it can, when it is an old one.
    """

    def __init__(
        self,
        certificate: Path | None,
        *,
        instead: Callable[[socket.socket], socket.socket] = plain,
        ciphers: str = "",
        newest: ssl.TLSVersion | None = None,
    ) -> None:
        self._dress = instead
        if certificate is not None:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.set_ciphers(f"{ciphers or 'DEFAULT'}:@SECLEVEL=0")
            if newest is not None:
                context.maximum_version = newest
            context.load_cert_chain(certificate, certificate.with_suffix(".key"))
            self._dress = lambda raw: context.wrap_socket(raw, server_side=True)
        self.registers = Registers(default_map())
        self._device = ModbusDevice(self.registers)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(0.05)
        self.port = self._listener.getsockname()[1]
        self._on = True
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        while self._on:
            try:
                raw, _ = self._listener.accept()
                raw.settimeout(0.3)
                with raw, self._dress(raw) as client:
                    while self._on and (frame := client.recv(300)):
                        pdu = self._device.answer(frame[7:])
                        head = frame[:4] + (len(pdu) + 1).to_bytes(2, "big") + frame[6:7]
                        client.sendall(head + pdu)
            except (OSError, ValueError, IndexError):
                continue

    def __enter__(self) -> Plc:
        return self

    def __exit__(self, *_: object) -> None:
        self._on = False
        self._thread.join(5)
        self._listener.close()


def spoken(plc: Plc, context: ssl.SSLContext, name: str = "plc", ticks: int = 40) -> str:
    """Try for some ticks; return "OK" once the PLC has answered, else the last trouble."""
    clock = MonotonicClock()
    transport = modbus(
        TlsWire("127.0.0.1", plc.port, context, name),
        device_id=1,
        register_map=euclid_map(),
        clock=clock,
    )
    said = ""
    try:
        for _ in range(ticks):
            if transport.transact([9] * 10, clock.now_ns() + 300_000_000)[0] is Outcome.OK:
                return "OK"
            said = transport.trouble or said
            clock.sleep_until_ns(clock.now_ns() + 5_000_000)
    finally:
        transport.close()
    return said


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("expired", "certificate has expired"),
        ("not yet in force", "certificate is not yet valid"),
        ("of another host", "its certificate has no plc in subjectAltName, and the common"),
        ("of the name in CN alone", "and the common name does not count: correct server_name"),
        ("CN right, name wrong", "its certificate has no plc in subjectAltName"),
        ("for clients alone", "certificate purpose"),
        ("signed with SHA-1", "too weak"),
        ("a key of 1024 bits", "too weak"),
    ],
)
def test_a_plc_with_an_odd_certificate_is_not_spoken_to(
    ours: Authority, kind: str, said: str
) -> None:
    with Plc(made(ours, kind)) as plc:
        told = spoken(plc, client_context(ours.certificate, None, None))
        assert "TLS with plc: " in told
        assert said in told
        assert plc.registers.writes == 0


@pytest.mark.parametrize(("kind", "name"), [("good", "plc"), ("by address", "127.0.0.1")])
def test_a_plc_with_its_name_in_the_right_place_is_spoken_to(
    ours: Authority, kind: str, name: str
) -> None:
    with Plc(made(ours, kind)) as plc:
        assert spoken(plc, client_context(ours.certificate, None, None), name) == "OK"


def test_certificates_of_strangers_are_none(ours: Authority, tmp_path: Path) -> None:
    stranger = Authority(tmp_path, "authority")  # by name the same one
    for certificate in (stranger.sign("plc"), stranger.certificate):  # signed by it, by itself
        with Plc(certificate) as plc:
            told = spoken(plc, client_context(ours.certificate, None, None))
            assert "certificate verify failed" in told
            assert plc.registers.writes == 0


OLD: dict[str, dict[str, Any]] = {
    "TLS 1.1": {"newest": ssl.TLSVersion.TLSv1_1},
    "CBC and SHA-1": {"ciphers": "ECDHE-ECDSA-AES128-SHA", "newest": ssl.TLSVersion.TLSv1_2},
    "no cipher": {"ciphers": "ECDHE-ECDSA-NULL-SHA", "newest": ssl.TLSVersion.TLSv1_2},
}


@pytest.mark.parametrize("kind", OLD)
@pytest.mark.filterwarnings("ignore:ssl.TLSVersion.TLSv1_1 is deprecated")
def test_a_plc_that_can_only_do_what_is_broken_is_not_spoken_to(
    ours: Authority, kind: str
) -> None:
    with Plc(made(ours, "good"), **OLD[kind]) as plc:
        assert "TLS with plc: " in spoken(plc, client_context(ours.certificate, None, None))
        assert plc.registers.writes == 0


@pytest.mark.parametrize("instead", [plain, silent])
def test_a_plc_without_tls_never_gets_a_plain_word(
    ours: Authority, instead: Callable[[socket.socket], socket.socket]
) -> None:
    with Plc(None, instead=instead) as plc:
        said = spoken(plc, client_context(ours.certificate, None, None))
        assert said != "OK"
        assert plc.registers.writes == 0


def test_a_plc_whose_certificate_was_taken_back_is_not_spoken_to(ours: Authority) -> None:
    crl = ours.folder / "crl.pem"
    with Plc(made(ours, "taken back")) as plc:
        assert "certificate revoked" in spoken(
            plc, client_context(ours.certificate, None, None, crl)
        )
        assert plc.registers.writes == 0
        assert spoken(plc, client_context(ours.certificate, None, None)) == "OK"
    with Plc(made(ours, "good")) as plc:
        assert spoken(plc, client_context(ours.certificate, None, None, crl)) == "OK"


# --- what the check says beforehand -----------------------------------------------------------

FILES = "{ ca: authority.pem, certificate: good.pem, private_key: good.key, crl: crl.pem }"


@pytest.fixture
def folder(ours: Authority, tmp_path: Path) -> Path:
    """A site's folder with the files of the plant's authority; the key is closed to others."""
    for path in (*ours.folder.glob("*.pem"), *ours.folder.glob("*.key")):
        shutil.copy(path, tmp_path)
    (tmp_path / "good.key").chmod(0o640)
    return tmp_path


def site(folder: Path, tls: str = FILES) -> Path:
    path = folder / "site.yaml"
    text = EUCLID.read_text().replace("    port: 5020", f"    port: 5020\n    tls: {tls}", 1)
    path.write_text(text)
    return path


def said_of(path: Path, now_s: float | None = None) -> dict[str, str]:
    """Return the words on the TLS files of a site by key."""
    return {str(i.path[-1]): i.text for i in issues(load_site(path), path.parent, now_s)}


def test_good_files_pass_without_a_word_on_tls_or_a_plain_wire(folder: Path) -> None:
    report = check_site(site(folder))
    assert report.ok
    assert not [finding for finding in report.warnings if "modbus_tcp" in finding.path]


@pytest.mark.parametrize("mode", [0o644, 0o604, 0o666])
def test_a_key_that_everybody_can_read_is_a_warning(folder: Path, mode: int) -> None:
    (folder / "good.key").chmod(mode)
    said = said_of(site(folder))["private_key"]
    assert f"every user of this machine can read the key in good.key (mode {mode:04o})" in said
    assert check_site(site(folder)).ok


def test_a_key_in_the_file_of_its_certificate_is_looked_at_too(folder: Path) -> None:
    both = folder / "both.pem"
    both.write_text((folder / "good.pem").read_text() + (folder / "good.key").read_text())
    tls = "{ ca: authority.pem, certificate: both.pem }"
    assert "can read the key in both.pem" in said_of(site(folder, tls))["certificate"]
    both.chmod(0o600)
    assert "certificate" not in said_of(site(folder, tls))


@pytest.mark.parametrize(
    ("days", "said"),
    [
        (31.0, None),
        (29.5, "expires on 2090-01-01, in 29 days: no connection is made after that. Renew it"),
        (1.5, "in 1 day: "),
        (0.5, "in 0 days: "),
        (-0.5, "expired on 2090-01-01: no connection is made with it. Renew it"),
    ],
)
def test_a_certificate_is_to_be_renewed_a_month_before_it_ends(
    folder: Path, days: float, said: str | None
) -> None:
    path = site(folder, "{ ca: authority.pem, certificate: good.pem, private_key: good.key }")
    now_s = datetime(2090, 1, 1, tzinfo=UTC).timestamp() - days * DAY_S
    told = said_of(path, now_s).get("certificate")
    assert told is None if said is None else told is not None and said in told


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("gone.pem", "gone.pem cannot be read (No such file"),
        ("authority.pem", "authority.pem holds no PEM revocation list (X509 CRL)"),
        ("foreign.pem", "foreign.pem is not of the authority whose certificate is in authority"),
        ("torn.pem", "torn.pem holds no PEM revocation list (X509 CRL) that can be used"),
    ],
)
def test_a_revocation_list_that_would_bar_everybody_is_refused(
    folder: Path, name: str, said: str
) -> None:
    Authority(folder, "stranger").revocation_list("foreign")
    (folder / "torn.pem").write_text("-----BEGIN X509 CRL-----\nMIIB\n-----END X509 CRL-----\n")
    report = check_site(site(folder, FILES.replace("crl.pem", name)))
    (finding,) = report.errors
    assert finding.path == "gateway.modbus_tcp.tls.crl"
    assert said in finding.text


def test_a_revocation_list_that_was_not_renewed_is_a_warning(folder: Path) -> None:
    path = site(folder)
    (der,) = pem_blocks((folder / "crl.pem").read_text(), REVOCATION_LIST)
    issued, due = list_dates(der)
    assert due is not None
    assert round((due - issued).total_seconds() / DAY_S) == 90  # as openssl was asked
    assert "crl" not in said_of(path, due.timestamp() - 1)
    late = said_of(path, due.timestamp() + 1)["crl"]
    assert late.startswith(f"the list in crl.pem was to be renewed by {due:%Y-%m-%d}: no conn")
    early = said_of(path, issued.timestamp() - DAY_S)["crl"]
    assert f"is of {issued:%Y-%m-%d}: no connection before" in early


def test_the_issuer_of_a_list_is_the_name_of_its_authority(ours: Authority) -> None:
    (der,) = pem_blocks((ours.folder / "crl.pem").read_text(), REVOCATION_LIST)
    (authority,) = pem_blocks(ours.certificate.read_text(), "CERTIFICATE")
    assert list_issuer(der) == subject(authority)


@pytest.mark.parametrize("of", [list_dates, list_issuer, subject])
def test_a_torn_list_or_certificate_is_no_crash(
    ours: Authority, of: Callable[[bytes], object]
) -> None:
    (der,) = pem_blocks((ours.folder / "crl.pem").read_text(), REVOCATION_LIST)
    for length in range(len(der)):
        with contextlib.suppress(ValueError):  # whatever else it raises would end the check
            of(der[:length])
