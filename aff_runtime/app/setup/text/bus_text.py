"""Section ``gateway`` of the site file on CAN: which signal carries what."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator

from aff_runtime.app.setup.asking.draft import SENT, SIGNAL, Draft
from aff_runtime.app.setup.asking.interview import angles_of, quantities_of, roll_names
from aff_runtime.app.setup.asking.questions import NONE
from aff_runtime.app.setup.bus.files import nodes_of

TEMPLATE = "gateway_can.template"
_PLAIN = re.compile(r"[A-Za-z][A-Za-z_]*[0-9.][A-Za-z0-9_.]*")  # no word such as on or null
_READ = ("plc_heartbeat", "status", "roll_id")
_SENT = {
    "aff_heartbeat": "aff_heartbeat",
    "state": "state",
    "echo": "echo_sent",
    "alarm": "alarm",
    "limit": "limit_word",
    "config_revision": "config_revision",
}


def bus_conditions(draft: Draft) -> dict[str, bool]:
    """Return which lines of the section stand."""
    echo = _read(draft, "aff_echo") != ""
    return {
        "dbc": draft.answers["wire"] == "can_dbc",
        "canopen": draft.answers["wire"] == "canopen_402",
        "echo": echo,
        "no_echo": not echo,
        "applied": any(_read(draft, f"applied.{roll}") for roll in roll_names(draft)),
        "further": any(name in draft.found for name in draft.further),
    }


def bus_places(draft: Draft) -> dict[str, str]:
    """Return what fills the places of the section."""
    answers = draft.answers
    own = [quantity.channel for quantity in (*quantities_of(draft), *angles_of(draft))]
    return {
        "wire": answers["wire"],
        "interface": answers["interface"],
        "bus_channel": quoted(answers["channel"]),
        "bitrate": answers["bitrate"],
        "dbc": quoted(answers.get("dbc", "")),
        "own_node": answers.get("own_node", ""),
        "nodes": "\n".join(_nodes(draft)),
        **{name: quoted(_read(draft, name)) for name in (*_READ, "aff_echo")},
        **{place: quoted(answers[f"{SENT}{name}"]) for name, place in _SENT.items()},
        "applied": "\n".join(_applied(draft)),
        "channels": "\n".join(_channels(draft, own)),
        "further": "\n".join(_channels(draft, draft.further)),
        "corrections": "\n".join(_corrections(draft)),
    }


def quoted(text: str) -> str:
    """Return a name as the site file writes it: in quotes where YAML needs them."""
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)


def _read(draft: Draft, name: str) -> str:
    """Return the signal that is read as ``name``; empty without one."""
    kept = draft.answers.get(f"{SIGNAL}{name}", NONE)
    return "" if kept == NONE else kept


def _nodes(draft: Draft) -> Iterator[str]:
    for name, (node_id, eds) in nodes_of(draft).items():
        value = draft.answers.get(f"lost.{name}", NONE)
        objects = "" if value == NONE else f', objects: [{{ object: "0x6007", value: {value} }}]'
        yield f"      {name}: {{ node: {node_id}, eds: {quoted(eds)}{objects} }}"


def _channels(draft: Draft, names: Iterable[str]) -> Iterator[str]:
    for name in names:
        signal = _read(draft, name)
        if not signal:
            continue
        wraps = ", wraps: true" if name.endswith("_rad") else ""
        scale = draft.answers[f"{name}.scale"]
        yield f"      {name}: {{ signal: {quoted(signal)}, scale: {scale}{wraps} }}"


def _applied(draft: Draft) -> Iterator[str]:
    for roll in roll_names(draft):
        signal = _read(draft, f"applied.{roll}")
        if signal:
            scale = draft.answers[f"applied.{roll}.scale"]
            yield f"      {roll}: {{ signal: {quoted(signal)}, scale: {scale} }}"


def _corrections(draft: Draft) -> Iterator[str]:
    for roll in roll_names(draft):
        signal = quoted(draft.answers[f"{SENT}correction.{roll}"])
        copy = draft.answers.get(f"{SENT}complement.{roll}", NONE)
        second = "" if copy == NONE else f", complement_signal: {quoted(copy)}"
        scale = draft.answers[f"correction_scale.{roll}"]
        yield f"      {roll}: {{ signal: {signal}{second}, scale: {scale} }}"
