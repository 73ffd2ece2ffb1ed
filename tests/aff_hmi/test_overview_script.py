"""What the page says of a moment that the screen server has told it: state, reason, old or not."""

from __future__ import annotations

import json
from pathlib import Path

from aff_hmi.frames import encode, opened
from aff_hmi.layout import Layout
from aff_hmi.view import view_of
from aff_hmi.watch import Observed
from aff_hmi.words import say_in
from tests.aff_hmi.moments import facts, seen
from tests.aff_hmi.scripts import STATIC, called

PAGE = """
const parts = {};
const bare = (id) => ({ id, dataset: {}, textContent: "", setAttribute: () => {},
  classList: { toggle: () => {} }, querySelector: () => null,
  closest: () => (parts[id] ??= part()) });
const part = () => ({ dataset: { from: "supervisor" }, querySelector: () => null,
  classList: { toggle(name, is) { this.is = is; } } });
const found = {};
const absent = ["also", "alarms", "coming", "events"];
const byId = (id) => (absent.includes(id) ? null : (found[id] ??= bare(id)));
const age = "{age}";
byId("words").dataset = { unknown: "UNKNOWN", was: "was", none: "-", old: age, since: age };
for (const id of ["why", "to-do"]) byId(id).closest();
globalThis.document = { documentElement: byId("root"), title: "Euclid", hidden: false,
  getElementById: byId, addEventListener: () => {}, dispatchEvent: () => {},
  querySelectorAll: (of) => (of === ".live" ? Object.values(parts) : []) };
Object.assign(byId("root"), { lang: "en" });
byId("root").dataset = { boot: "b" };
globalThis.window = { addEventListener: () => {} };
globalThis.location = { protocol: "http:", host: "h" };
globalThis.setInterval = () => 0;
globalThis.CustomEvent = class {};
globalThis.WebSocket = class { constructor() { globalThis.socket = this; } send() {} close() {} };
globalThis.shown = (frame) => {
  socket.onmessage({ data: JSON.stringify({ ...frame, echo: performance.now() }) });
  const [why, todo] = [parts.why.classList.is, parts["to-do"].classList.is];
  const said = ["state", "was", "why"].map((id) => byId(id).textContent);
  return [...said, why && todo, why || todo];
};
"""
INSTEAD = {
    "box": "export const isOpen = 0, isText = 0, openBox = 0;",
    "sound": "export const otherSound = 0;",
    "units": "export const digitsOf = 0, inUnit = 0, otherUnits = 0, unitName = 0;",
}


def frame(moment: Observed) -> object:
    view = view_of(moment, Layout(), say_in("en"))
    return json.loads(opened(encode(view, number=1, boot="b"), 0.0))


def test_a_reason_of_now_is_said_where_no_tick_tells_the_state_and_an_old_one_crossed_out(
    tmp_path: Path,
) -> None:
    ended = seen(row=None, tick_age_s=None, facts=facts(control_pid=0))
    frames = (
        frame(seen()),
        frame(seen(tick_age_s=7.0)),
        frame(seen(row=None, tick_age_s=None)),
        frame(ended),
        frame(Observed(trouble="no service opens this door")),
    )
    fresh = (STATIC / "freshness.js").read_text(encoding="utf-8")
    instead = {**INSTEAD, "freshness": fresh}
    said = called(tmp_path, "overview", "given.map(shown)", *frames, page=PAGE, instead=instead)
    (active, silent, starts, gone, none) = said
    assert active == ["ACTIVE", "", "the correction goes out", False, False]
    assert silent == ["UNKNOWN", "was ACTIVE", "the correction goes out", True, True]
    assert starts == ["UNKNOWN", "", "the service starts", False, False]
    assert gone[:2] + gone[3:] == ["UNKNOWN", "", False, False]
    assert gone[2] == "the control process has ended; it comes back idle"
    assert none[:2] + none[3:] == ["UNKNOWN", "", False, False]
    assert none[2] == "no service answers; whether a correction goes out is not known here"
