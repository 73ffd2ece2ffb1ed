"""A crowd of the network leaves room for the panel, and one stranger for the others."""

from __future__ import annotations

from collections import Counter

import pytest

from aff_hmi.admission import admits

MOST = 64


def let_in(come: list[str]) -> Counter[str]:
    inside: list[str] = []
    for address in come:
        if admits(address, inside, MOST):
            inside.append(address)
    return Counter(inside)


def test_one_stranger_leaves_room_for_others_of_the_network() -> None:
    found = let_in(["192.168.7.66"] * 100 + ["192.168.7.9"])
    assert found == {"192.168.7.66": MOST // 2, "192.168.7.9": 1}


@pytest.mark.parametrize("panel", ["127.0.0.1", "::1"])
def test_a_crowd_of_strangers_leaves_room_for_the_panel(panel: str) -> None:
    found = let_in([f"10.0.{n}.1" for n in range(100)] + [panel] * 100)
    assert found[panel] == MOST // 4
    assert found.total() == MOST


def test_the_panel_may_take_every_place() -> None:
    assert let_in(["127.0.0.1"] * 100 + ["192.168.7.9"]) == {"127.0.0.1": MOST}


@pytest.mark.parametrize("address", ["", "fe80::1%eth0", "testclient"])
def test_who_has_no_address_we_know_is_of_the_network(address: str) -> None:
    assert let_in([address] * 100)[address] == MOST // 2
