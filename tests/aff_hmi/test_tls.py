"""Over a network: TLS 1.2 at least, whatever the machine's own settings allow."""

from __future__ import annotations

import ssl
import subprocess
from pathlib import Path

import pytest

pytest.importorskip("uvicorn")

from aff_hmi.hub import Hub
from aff_hmi.listening import listening
from aff_hmi.server import config_of
from aff_hmi.watch import Watch
from aff_runtime.base.errors import ConfigError
from tests.aff_hmi.served import certificate
from tests.doubles.virtual_clock import VirtualClock


@pytest.fixture
def served(tmp_path: Path) -> ssl.SSLContext:
    """Return what the server speaks with."""
    certificate(tmp_path)
    place = listening(
        "127.0.0.1:8480", ("aff-line1",), tmp_path / "cert.pem", tmp_path / "key.pem", None
    )
    clock = VirtualClock(1)
    config = config_of(place, Hub(Watch(tmp_path / "door.sock", clock), clock), "en")
    assert config.ssl is not None
    return config.ssl


def shake(server: ssl.SSLContext, newest: ssl.TLSVersion) -> str | None:
    """Return the version that is agreed on with a browser that speaks up to ``newest``."""
    client = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    client.check_hostname, client.verify_mode = False, ssl.CERT_NONE
    client.set_ciphers("ALL:@SECLEVEL=0")
    client.minimum_version, client.maximum_version = ssl.TLSVersion.MINIMUM_SUPPORTED, newest
    to_server, to_client = ssl.MemoryBIO(), ssl.MemoryBIO()
    ends = [
        client.wrap_bio(to_client, to_server),
        server.wrap_bio(to_server, to_client, server_side=True),
    ]
    for _ in range(4):
        for end in ends:
            try:
                end.do_handshake()
            except ssl.SSLWantReadError:
                continue
    return ends[0].version()


@pytest.mark.filterwarnings("ignore:ssl.TLSVersion.TLSv1_1 is deprecated")
def test_nothing_older_than_tls_1_2_is_spoken(served: ssl.SSLContext) -> None:
    assert served.minimum_version is ssl.TLSVersion.TLSv1_2
    assert shake(served, ssl.TLSVersion.TLSv1_3) == "TLSv1.3"
    assert shake(served, ssl.TLSVersion.TLSv1_2) == "TLSv1.2"
    with pytest.raises(ssl.SSLError):
        shake(served, ssl.TLSVersion.TLSv1_1)


def test_a_key_of_another_certificate_is_told_before_anything_listens(
    served: ssl.SSLContext, tmp_path: Path
) -> None:
    made = ["genpkey", "-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-256"]
    other = tmp_path / "other.pem"
    subprocess.run(["openssl", *made, "-out", str(other)], check=True, capture_output=True)
    place = listening("127.0.0.1:8480", (), tmp_path / "cert.pem", other, None)
    clock = VirtualClock(1)
    with pytest.raises(ConfigError, match="cannot be used for TLS"):
        config_of(place, Hub(Watch(tmp_path / "door.sock", clock), clock), "en")
