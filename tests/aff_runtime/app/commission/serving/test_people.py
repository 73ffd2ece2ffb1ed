"""Who commissions: one person, of the role, at the panel, by a password that was checked here."""

import asyncio

import pytest

from aff_runtime.app.commission.link.messages import Refusal, Why
from aff_runtime.app.commission.serving.people import IDLE_NS, Holder, People
from aff_runtime.app.hand import accounts
from aff_runtime.app.hand.accounts import Account, Accounts, secret_of, write_accounts
from aff_runtime.app.hand.may import Place, Role
from tests.doubles.virtual_clock import VirtualClock

PASSWORD = "tension, 90 N"
ROLES = {"carl": Role.COMMISSION, "cleo": Role.COMMISSION, "anna": Role.OPERATE}


@pytest.fixture
def clock():
    return VirtualClock(1)


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.setattr(accounts, "_N", 2)
    path = tmp_path / "accounts"
    secret = secret_of(PASSWORD)
    write_accounts(path, [Account(name=n, role=r, secret=secret) for n, r in ROLES.items()])
    return path


@pytest.fixture
def people(file, clock):
    return People(Accounts(file), clock, Place.PANEL)


def opened(people, name="carl", password=PASSWORD, place=Place.PANEL, *, over=False):
    return asyncio.run(people.open(name, password, place, over=over))


@pytest.mark.parametrize(
    ("name", "password", "place", "why"),
    [
        ("carl", "another one", Place.PANEL, Why.PASSWORD),
        ("nobody", PASSWORD, Place.PANEL, Why.PASSWORD),
        ("anna", PASSWORD, Place.PANEL, Why.ROLE),
        ("carl", PASSWORD, Place.NETWORK, Why.PLACE),
    ],
)
def test_who_may_not_is_told_why(people, name, password, place, why):
    assert opened(people, name, password, place) == Refusal(why=why)
    assert people.holder is None


def test_the_network_may_where_it_was_let(file, clock):
    people = People(Accounts(file), clock, Place.NETWORK)
    assert isinstance(opened(people, place=Place.NETWORK), Holder)


def test_one_person_is_in_and_another_takes_it_over_by_saying_so(people):
    first = opened(people)
    assert opened(people, "cleo") == Refusal(why=Why.BUSY, name="carl")
    assert people.by_key(first.key, Place.PANEL) is first
    second = opened(people, "cleo", over=True)
    assert people.by_key(first.key, Place.PANEL) is None
    assert people.by_key(second.key, Place.PANEL) is second


def test_a_key_counts_from_its_own_place_alone(people):
    key = opened(people).key
    assert people.by_key(key, Place.NETWORK) is None
    assert people.by_key("", Place.PANEL) is None
    assert people.by_key(key + "x", Place.PANEL) is None


def test_nobody_is_in_after_a_quarter_of_an_hour_without_a_press(people, clock):
    key = opened(people).key
    clock.advance_ns(IDLE_NS)
    assert people.by_key(key, Place.PANEL) is not None
    clock.advance_ns(IDLE_NS + 1)
    assert people.by_key(key, Place.PANEL) is None


def test_who_has_no_account_any_more_is_out(people, file):
    key = opened(people).key
    write_accounts(file, [Account(name="cleo", role=Role.COMMISSION, secret=secret_of(PASSWORD))])
    assert people.by_key(key, Place.PANEL) is None


def test_five_wrong_tries_a_minute_and_as_many_right_ones_as_there_are_steps(people, clock):
    for _ in range(13):
        assert isinstance(opened(people), Holder)
    for _ in range(5):
        assert opened(people, password="guessed").why is Why.PASSWORD
    assert opened(people).why is Why.WAIT
    assert isinstance(opened(people, "cleo", over=True), Holder)
    clock.advance_ns(12 * 10**9)
    assert isinstance(opened(people, over=True), Holder)


def test_made_up_names_give_nobody_more_tries(people):
    for _ in range(5):
        assert opened(people, password="guessed").why is Why.PASSWORD
    for number in range(1000):
        assert opened(people, f"made-up-{number}").why in (Why.PASSWORD, Why.WAIT)
    assert opened(people).why is Why.WAIT


def test_all_names_that_are_none_share_five_tries_and_take_none_of_an_account(people):
    found = [opened(people, f"made-up-{number}").why for number in range(20)]
    assert found == [Why.PASSWORD] * 5 + [Why.WAIT] * 15
    assert isinstance(opened(people), Holder)


def test_a_name_that_is_none_costs_as_much_as_a_wrong_password(people, monkeypatch):
    hashed = []

    def counted(password, salt, was=accounts._hash):
        hashed.append(password)
        return was(password, salt)

    monkeypatch.setattr(accounts, "_hash", counted)
    for name in ("carl", "nobody-here"):
        assert opened(people, name, "guessed").why is Why.PASSWORD
    assert hashed == ["guessed"] * 2
