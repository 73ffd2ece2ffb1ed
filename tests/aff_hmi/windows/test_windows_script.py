"""The list of kept windows: one is let go of by the second press, and never by a first one."""

from __future__ import annotations

from pathlib import Path

from tests.aff_hmi.scripts import called

SEE = """
export const pressed = [];
const list = { rows: [], replaceChildren(...rows) { this.rows = rows; } };
export const byId = (name) => (name === "windows" ? list : {});
const windows = [{ number: 7, name: "" }, { number: 8, name: "" }];
export const ask = async () => ({ ok: true, windows });
export const press = async (path, said) => { pressed.push([path, said.number]); return ""; };
export const put = (element, text) => { element.textContent = text; };
export const part = (tag, kind, textContent) =>
  ({ tag, textContent, parts: [], append(...parts) { this.parts.push(...parts); } });
export const at = String;
export const number = String;
export const words = new Proxy({}, { get: (_, name) => name });
"""
PLAY = """
const { byId, pressed } = await import("./see.mjs");
const shown = { open() {}, lay() {}, isLaid: () => false };
const found = [];
const last = (n) => byId("windows").rows[n].parts.at(-1).parts.at(-1);
for (const step of given) {
  if (step === "list") await of.listWindows(shown);
  else await last(step).onclick();
  found.push([last(0).textContent, last(1).textContent, pressed.length]);
}
"""


def test_a_list_that_is_made_anew_after_the_first_press_still_asks(tmp_path: Path) -> None:
    steps = ("list", 0, "list", 1, "list", 1, "list")
    found = called(
        tmp_path, "windows", "[found, pressed]", *steps, before=PLAY, instead={"see": SEE}
    )
    assert found[0][:5] == [
        ["letGo", "letGo", 0],
        ["sure", "letGo", 0],
        ["sure", "letGo", 0],
        ["sure", "sure", 0],
        ["letGo", "sure", 0],
    ]
    assert found[0][-1] == ["letGo", "letGo", 1]
    assert found[1] == [["/let-go", 8]]
