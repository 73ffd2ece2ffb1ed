"""What the screen sees of its own machine: a clock that is set, certificates that end."""

from __future__ import annotations

import shutil
import ssl
import subprocess
from pathlib import Path

import pytest

from aff_hmi.hub import Hub
from aff_hmi.machine import SHOWN_NS, Machine, ends_of
from aff_hmi.watch import Watch
from tests.doubles.virtual_clock import VirtualClock

needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is needed")


class Wall:
    def __init__(self, clock: VirtualClock) -> None:
        self.clock, self.offset_s = clock, 1.8e9

    def __call__(self) -> float:
        return self.offset_s + 1e-9 * self.clock.now_ns()


@pytest.mark.parametrize("step_s", [3600.0, -1.0, 0.6])
def test_a_clock_that_is_set_is_told_by_how_much_and_for_ten_minutes(step_s: float) -> None:
    clock = VirtualClock(1)
    wall = Wall(clock)
    machine = Machine(clock, wall)
    for _ in range(20):
        clock.advance_ns(100_000_000)
        machine.look()
        assert machine.clock_step_s == 0.0
    wall.offset_s += step_s
    machine.look()
    assert machine.clock_step_s == pytest.approx(step_s, abs=1e-5)
    clock.advance_ns(SHOWN_NS)
    machine.look()
    assert machine.clock_step_s == pytest.approx(step_s, abs=1e-5)
    clock.advance_ns(2)
    machine.look()
    assert machine.clock_step_s == 0.0


def test_a_clock_that_is_slewed_was_not_set_however_long_nobody_looked() -> None:
    """The kernel slews by 500 ppm at most: 0.3 s in ten minutes without a look."""
    clock = VirtualClock(1)
    wall = Wall(clock)
    machine = Machine(clock, wall)
    machine.look()
    clock.advance_ns(600_000_000_000)
    wall.offset_s += 500e-6 * 600.0
    machine.look()
    assert machine.clock_step_s == 0.0


def made(folder: Path, name: str, days: int) -> Path:
    path = folder / name
    how = (
        f"req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days {days} -subj /CN=aff"
    )
    files = ["-keyout", str(folder / "key.pem"), "-out", str(path)]
    subprocess.run(["openssl", *how.split(), *files], check=True, capture_output=True)
    return path


def told_by_openssl(path: Path) -> float:
    asked = ["openssl", "x509", "-noout", "-enddate", "-in", str(path)]
    said = subprocess.run(asked, check=True, capture_output=True, text=True).stdout
    return ssl.cert_time_to_seconds(said.strip().removeprefix("notAfter="))


@needs_openssl
@pytest.mark.parametrize("days", [1, 365, 20_000])  # the last one after 2049: another kind of time
def test_the_end_of_a_certificate_is_the_one_that_openssl_reads(tmp_path: Path, days: int) -> None:
    path = made(tmp_path, "cert.pem", days)
    assert ends_of(path) == (told_by_openssl(path),)


@needs_openssl
def test_of_a_chain_the_first_to_end_counts(tmp_path: Path) -> None:
    late, soon = made(tmp_path, "late.pem", 300), made(tmp_path, "soon.pem", 20)
    chain = tmp_path / "chain.pem"
    chain.write_text(f"words before it\n{late.read_text()}{soon.read_text()}")
    clock = VirtualClock(1)
    wall = Wall(clock)
    machine = Machine(clock, wall, (chain,))
    assert machine.certificate_s == pytest.approx(told_by_openssl(soon) - wall())
    hub = Hub(Watch(Path("/nowhere"), clock), clock, machine=machine)
    assert f"\naff_hmi_certificate_seconds {machine.certificate_s!r}\n" in hub.metrics()
    plain = Hub(Watch(Path("/nowhere"), clock), clock)
    assert "aff_hmi_certificate_seconds" not in plain.metrics()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no certificate",
        "-----BEGIN CERTIFICATE-----\n-----END CERTIFICATE-----\n",
        "-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n",
        "-----BEGIN CERTIFICATE-----\n\u00e9",
    ],
)
def test_what_is_no_certificate_ends_nothing(tmp_path: Path, text: str) -> None:
    path = tmp_path / "cert.pem"
    path.write_text(text)
    assert ends_of(path) == ()
    assert ends_of(tmp_path / "none.pem") == ()
    clock = VirtualClock(1)
    assert Machine(clock, Wall(clock), (path,)).certificate_s is None
