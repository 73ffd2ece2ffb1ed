"""Pages tell times by one clock, the gateway's: that of a browser may be hours off."""

from __future__ import annotations

from pathlib import Path

from tests.aff_hmi.scripts import called

PAGE = """
const heard = {};
globalThis.document = {
  documentElement: { lang: "en", dataset: {} },
  getElementById: () => ({ dataset: {} }),
  addEventListener: (name, hear) => (heard[name] = hear),
};
globalThis.browser = { at_s: 1e9, frame: (detail) => heard.frame({ detail }) };
Date.now = () => 1000 * browser.at_s;
"""
PLAY = """
const found = [of.nowS()];
for (const [at_s, frame] of given) {
  browser.at_s = at_s;
  if (frame !== 0) browser.frame(frame);
  found.push(of.nowS());
}
"""


def test_now_is_what_the_newest_frame_has_said_and_goes_on(tmp_path: Path) -> None:
    steps = ([1.7e9, {"utc_s": 1.8e9}], [1.7e9 + 3, 0], [1.7e9 + 5, None])
    found = called(tmp_path, "clock", "found", *steps, page=PAGE, before=PLAY)
    assert found == [1e9, 1.8e9, 1.8e9 + 3, 1.8e9 + 5]
