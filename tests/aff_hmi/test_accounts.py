"""Accounts are made on the machine, and a file that is not to be trusted holds none."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import pytest

from aff_hmi.main import main
from aff_hmi.sessions import MAX_SESSIONS, Sessions
from aff_runtime.app.hand import accounts
from aff_runtime.app.hand.accounts import Account, Accounts, is_password, read_accounts, secret_of
from aff_runtime.app.hand.may import Place, Role
from aff_runtime.base.errors import ConfigError
from tests.aff_hmi.pressed import quick
from tests.doubles.virtual_clock import VirtualClock

PASSWORD = "tension, 90 N"


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    quick(monkeypatch)


def account(*words: str, typed: str = PASSWORD) -> int:
    before = sys.stdin
    sys.stdin = io.StringIO(f"{typed}\n")
    try:
        return main(["account", *words])
    finally:
        sys.stdin = before


def test_an_account_is_made_listed_changed_and_taken_away(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "accounts"
    where = ("--accounts", str(file))
    assert account("add", "anna", "--role", "operate", *where) == 0
    assert account("add", "vera", "--role", "view", *where) == 0
    assert file.stat().st_mode & 0o777 == 0o640
    assert PASSWORD not in file.read_text()
    found = Accounts(file)
    assert found.check("anna", PASSWORD) == found.find("anna")
    assert found.check("anna", PASSWORD + " ") is None
    assert account("list", *where) == 0
    assert "anna  operate\nvera  view\n" in capfd.readouterr().out
    assert account("add", "anna", "--role", "view", *where, typed="another password") == 0
    changed = found.check("anna", "another password")
    assert changed is not None
    assert changed.role is Role.VIEW
    assert account("remove", "anna", *where) == 0
    assert found.find("anna") is None
    assert account("remove", "anna", *where) == 4


@pytest.mark.parametrize(
    ("name", "password"),
    [
        ("anna", "short"),
        ("anna", "x" * 257),
        ("a:b", PASSWORD),
        ("-anna", PASSWORD),
        ("", PASSWORD),
    ],
)
def test_what_makes_no_account_is_said(
    tmp_path: Path, name: str, password: str, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ("add", "--role", "view", "--accounts", str(tmp_path / "a"), "--", name)
    assert account(*words, typed=password) == 2
    assert "has" in capfd.readouterr().err
    assert not (tmp_path / "a").exists()


PIN = "204816"


def with_a_pin(tmp_path: Path) -> Accounts:
    words = ("add", "--role", "operate", "--pin", "--accounts", str(tmp_path / "a"), "anna")
    assert account(*words, typed=f"{PASSWORD}\n{PIN}") == 0
    return Accounts(tmp_path / "a")


def test_a_pin_is_a_password_at_the_panel_and_nowhere_else(tmp_path: Path) -> None:
    found = with_a_pin(tmp_path)
    assert found.check("anna", PASSWORD) == found.check("anna", PASSWORD, at_panel=True)
    assert found.check("anna", PASSWORD) is not None
    assert found.check("anna", PIN, at_panel=True) == found.find("anna")
    assert found.check("anna", PIN) is None
    assert found.check("anna", "204817", at_panel=True) is None
    assert PIN not in (tmp_path / "a").read_text()


def test_an_account_without_a_pin_is_not_let_in_by_six_digits(tmp_path: Path) -> None:
    assert account("add", "--role", "view", "--accounts", str(tmp_path / "a"), "anna") == 0
    found = Accounts(tmp_path / "a")
    assert found.check("anna", PIN, at_panel=True) is None
    assert found.check("nobody", PIN, at_panel=True) is None


@pytest.mark.parametrize(
    ("role", "name", "pin", "said"),
    [
        ("commission", "carl", PIN, "not for role commission"),
        ("view", "vera", "20481", "has 6 digits"),
        ("view", "vera", "20481a", "has 6 digits"),
        ("view", "nobody", PIN, "another name"),
    ],
)
def test_what_is_no_pin_or_not_for_one_is_said(
    tmp_path: Path, role: str, name: str, pin: str, said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ("add", "--role", role, "--pin", "--accounts", str(tmp_path / "a"), name)
    assert account(*words, typed=f"{PASSWORD}\n{pin}") == 2
    assert said in capfd.readouterr().err
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize("mode", [0o644, 0o660, 0o602])
def test_a_file_that_is_open_to_others_is_refused(tmp_path: Path, mode: int) -> None:
    file = tmp_path / "accounts"
    file.write_text(Account(name="anna", role=Role.VIEW, secret=secret_of(PASSWORD)).line + "\n")
    file.chmod(mode)
    with pytest.raises(ConfigError, match="opens it to others"):
        read_accounts(file)
    assert Accounts(file).find("anna") is None


def test_what_is_no_file_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "accounts", 0o600)
    with pytest.raises(ConfigError, match="is no file"):
        read_accounts(tmp_path / "accounts")


def test_a_file_of_another_user_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "accounts"
    accounts.write_accounts(file, [])
    monkeypatch.setattr(accounts, "uids_with", lambda _: frozenset({os.geteuid() + 1}))
    with pytest.raises(ConfigError, match="owns it"):
        read_accounts(file)


def test_a_file_that_is_opened_to_others_later_holds_no_account_any_more(tmp_path: Path) -> None:
    file = tmp_path / "accounts"
    one = Account(name="anna", role=Role.VIEW, secret=secret_of(PASSWORD))
    accounts.write_accounts(file, [one])
    found = Accounts(file)
    assert found.find("anna") == one
    file.chmod(0o666)
    assert found.find("anna") is None


@pytest.mark.parametrize(
    "line",
    [
        "anna",
        "anna:operate:plain:x",
        "anna:root:{secret}",
        "an na:view:{secret}",
        "anna:view:{secret}:more",
        "anna:view:scrypt:1:8:3:AAAA:AAAA",
        "anna:view:scrypt:2:8:3:\u00e4:AAAA",
        "anna:view:scrypt:2:8:3::",
    ],
)
def test_a_line_that_is_no_account_is_named(tmp_path: Path, line: str) -> None:
    file = tmp_path / "accounts"
    good = Account(name="vera", role=Role.VIEW, secret=secret_of(PASSWORD))
    file.write_text(f"{good.line}\n{line.replace('{secret}', good.secret)}\n")
    file.chmod(0o600)
    with pytest.raises(ConfigError, match=":2: is no account"):
        read_accounts(file)
    assert Accounts(file).find("vera") is None


def test_a_name_that_is_none_costs_what_a_wrong_password_costs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "accounts"
    accounts.write_accounts(
        file, [Account(name="anna", role=Role.VIEW, secret=secret_of(PASSWORD))]
    )
    found, hashed = Accounts(file), list[str]()
    real = accounts._hash

    def counted(password: str, salt: bytes) -> bytes:
        hashed.append(password)
        return real(password, salt)

    monkeypatch.setattr(accounts, "_hash", counted)
    assert found.check("anna", "wrong") is None
    assert found.check("nobody", "wrong") is None
    assert hashed == ["wrong", "wrong"]


def test_any_text_may_be_a_password() -> None:
    for password in ("pa:ss:word:x", "\u00fc\u20ac\U0001f511 long enough", "\udcff" * 10):
        assert is_password(password, secret_of(password))
        assert not is_password(password + "x", secret_of(password))


def test_sessions_are_not_kept_without_end(tmp_path: Path) -> None:
    file = tmp_path / "accounts"
    one = Account(name="anna", role=Role.VIEW, secret=secret_of(PASSWORD))
    accounts.write_accounts(file, [one])
    sessions = Sessions(Accounts(file), VirtualClock(1))
    tokens = [sessions.begin(one, Place.PANEL) for _ in range(MAX_SESSIONS + 3)]
    there = [sessions.find(token, Place.PANEL) is not None for token in tokens]
    assert there == [False] * 3 + [True] * MAX_SESSIONS


def test_an_account_that_logs_in_without_end_drives_out_nobody_else(tmp_path: Path) -> None:
    file = tmp_path / "accounts"
    secret = secret_of(PASSWORD)
    anna = Account(name="anna", role=Role.OPERATE, secret=secret)
    vera = Account(name="vera", role=Role.VIEW, secret=secret)
    accounts.write_accounts(file, [anna, vera])
    sessions = Sessions(Accounts(file), VirtualClock(1))
    token = sessions.begin(anna, Place.PANEL)
    for _ in range(2 * MAX_SESSIONS):
        sessions.begin(vera, Place.NETWORK)
    assert sessions.find(token, Place.PANEL) is not None


def test_without_accounts_nothing_is_served(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["--hand-socket", str(tmp_path / "hand.sock"), "--accounts", str(tmp_path / "none")]
    assert main([*words, "--listen", "127.0.0.1:9"]) == 2
    assert "aff-hmi account add" in capfd.readouterr().err


def test_with_a_hand_a_network_is_refused_without_tls(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["--hand-socket", str(tmp_path / "hand.sock"), "--accounts", str(tmp_path / "none")]
    assert main([*words, "--listen", "0.0.0.0:8480"]) == 2
    assert "needs TLS" in capfd.readouterr().err
