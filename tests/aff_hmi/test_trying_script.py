"""The script that shows a try: what nobody says any more is neither shown as ended nor counted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.aff_hmi import scripts

SHA256 = "7" * 64
SEE = """
const made = new Map();
const classes = { toggle() {} };
export function byId(name) {
  if (!made.has(name)) {
    const dataset = name === "tried-left" ? { left: "{seconds} s", unknown: "? s" } : {};
    made.set(name, { dataset, classList: classes, hidden: true, textContent: "", value: "why" });
  }
  return made.get(name);
}
export const put = (box, text) => { box.textContent = text; };
"""
WORK = """export const posted = [];
export const post = async (...all) => { posted.push(all); return { ok: true }; };
export const whenDone = () => {};"""
DRAFT = "export const keepTyped = () => {}; export const done = () => {};"
MAIN = """
import { readFileSync } from "node:fs";
let now = 0;
performance.now = () => now;
globalThis.setInterval = () => {};
const { byId } = await import("./see.mjs");
const { posted } = await import("./work.mjs");
const { showTried } = await import("./trying.mjs");
const found = [];
for (const step of JSON.parse(readFileSync(0, "utf8"))) {
  now = step.at_ms;
  const tried = showTried(step.state);
  const event = { preventDefault() {}, submitter: { value: step.press } };
  if (step.press) byId("trying").onsubmit(event);
  found.push({ tried, shown: !byId("trying").hidden, left: byId("tried-left").textContent });
}
console.log(JSON.stringify({ found, posted }));
"""
TRIED = {
    "ok": True,
    "is_open": True,
    "left_s": 40,
    "service": {"answers": True, "trying": "settings 77 by carl: 40 s left", "tried": SHA256},
}
SILENT = {"ok": True, "is_open": True, "left_s": None, "service": {"answers": False}}
ENDED = TRIED | {"left_s": None, "service": {"answers": True, "trying": "", "tried": ""}}


@pytest.fixture
def played(tmp_path: Path) -> Any:
    """Return what plays steps to the script: what each shows, and what was posted."""
    scripts.put_script(tmp_path, "trying", {"see": SEE, "work": WORK, "draft": DRAFT})
    return lambda *steps: scripts.played(tmp_path, MAIN, steps)


@pytest.mark.parametrize("lost", [SILENT, {"ok": False}, None])
def test_a_try_of_which_nobody_says_that_it_has_ended_stays_with_a_question_mark(
    played: Any, lost: Any
) -> None:
    steps = [(0, TRIED), (1000, lost), (4000, lost), (5000, ENDED)]
    first, soon, late, ended = played(*({"at_ms": ms, "state": s} for ms, s in steps))["found"]
    words = TRIED["service"]["trying"]  # type: ignore[index]
    assert first == {"tried": words, "shown": True, "left": "40 s"}
    assert soon == first
    assert late == {"tried": words, "shown": True, "left": "? s"}
    assert ended == {"tried": "", "shown": False, "left": ""}


@pytest.mark.parametrize("press", ["keep", "undo"])
def test_a_press_names_the_try_that_is_shown(played: Any, press: str) -> None:
    steps = ({"at_ms": 0, "state": TRIED}, {"at_ms": 1000, "state": SILENT, "press": press})
    ((path, said),) = played(*steps)["posted"]
    assert path == "/card/settings"
    assert (said["do"], said["measured"], said["reason"]) == (press, SHA256, "why")
