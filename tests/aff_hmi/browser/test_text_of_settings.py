"""The text of the site file in a browser, quickly: the real jobs, in place of a service its check.

A try and its keeping at a real service are in ``test_settings``.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")

from aff_hmi.commission.link import Commission
from aff_runtime.app.commission import paths
from aff_runtime.app.commission.link.answers import Answer, Done, decode, encode
from aff_runtime.app.commission.link.messages import Refusal, Request, Why
from aff_runtime.app.commission.paths import Paths
from aff_runtime.app.commission.settings import form_jobs as settings_form_jobs
from aff_runtime.app.commission.settings import text_jobs as settings_text_jobs
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import AffError
from aff_runtime.config.diff import diff_sites
from tests.aff_hmi.browser.eyes import Page
from tests.aff_hmi.browser.staged import Stage, ready
from tests.aff_hmi.browser.test_drafts import logged_in
from tests.aff_hmi.browser.test_not_known import STATE
from tests.aff_runtime.app.judged_here import judged_here
from tests.parameter_records import CONFIG

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]
KEY = "actuators.unwind.soft_start_s"
FIELD = f'.setting [name="{KEY}"]'
BLOCK = "      - { roll: unwind, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }"
LAST = "      - { roll: swrap_follower, orders: [1], settle_s: 8, amp_limit_m_s: 0.03 }\n"


class Jobs(Commission):
    """Does the jobs of settings in this process; what is saved is written."""

    def __init__(self, where: Paths) -> None:
        super().__init__(Path("/nowhere"))
        self.where = where

    async def _ask(self, asked: Request) -> Answer:
        jobs: dict[str, Callable[..., Answer]] = {
            "settings": settings_form_jobs.form,
            "settings_text": settings_text_jobs.text,
            "settings_diff": settings_form_jobs.difference,
        }
        if asked.do not in jobs:
            return Done()
        try:
            answer = jobs[asked.do](self.where, asked, None)
        except AffError as error:
            answer = Refusal(why=Why.REFUSED, name=str(error))
        return decode(asked.do, json.dumps(json.loads(encode(answer))).encode())


@pytest.fixture
def where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Paths:
    site = tmp_path / "site.yaml"
    shutil.copyfile(CONFIG / "euclid_blocks.yaml", site)

    def service(where: Paths, **said: Any) -> SettingsAnswer:
        running = judged_here(site, tmp_path).checked().site
        if said["act"] != "diff":
            return SettingsAnswer()
        other = judged_here(site, tmp_path, said["text"]).checked().site
        return SettingsAnswer(changes=tuple(map(str, diff_sites(running, other))))

    for module in (paths, settings_form_jobs, settings_text_jobs):
        monkeypatch.setattr(module, "load_parameters", judged_here)
    monkeypatch.setattr(settings_form_jobs, "ask_settings", service)
    return Paths(site=site, state=tmp_path, socket=tmp_path / "none", card=tmp_path / "card")


@pytest.fixture
def stage(tmp_path: Path, where: Paths) -> Iterator[Stage]:
    found = Stage(tmp_path / "stage", keeps=True, commission=Jobs(where))
    yield found
    found.close()


def at_settings(chromium: Any, stage: Stage) -> Page:
    page = logged_in(chromium, stage)
    stage.show(ready())
    state = {**STATE, "job": None}
    page.page.route("**/data/commissioning?*", lambda route: route.fulfill(json=state))
    page.page.goto(f"{stage.url}settings")
    page.await_selector("html[data-settings=shown]")
    return page


def turned(page: Page) -> str:
    page.page.click("#as-text")
    page.await_selector("#text-view:not([hidden])")
    return str(page.page.input_value("#text"))


def looked(page: Page) -> str:
    page.page.click("#edit button[type=submit]")
    page.await_selector("#difference:not([hidden])")
    return page.text("#changes")


def test_form_and_text_edit_one_thing(chromium, stage: Stage, where: Paths) -> None:
    file = where.site.read_text(encoding="utf-8")
    page = at_settings(chromium, stage)
    soft = page.page.input_value(FIELD)
    page.page.fill(FIELD, "4.5")
    assert turned(page) == file.replace(f"soft_start_s: {soft}", "soft_start_s: 4.5", 1)
    typed = file.replace(LAST, f"{LAST}{BLOCK}\n").replace(
        f"soft_start_s: {soft}", "soft_start_s: 5.5", 1
    )
    page.page.fill("#text", typed)
    page.page.click("#as-form")
    page.page.wait_for_selector("#text-view[hidden]", state="attached")
    assert page.page.input_value(FIELD) == "5.5"
    assert f"before: {soft} s" in page.text(f'.setting[data-path="{KEY}"]')
    changes = looked(page)
    assert f"{KEY}: {soft} s -> 5.5 s (applies at once)" in changes
    assert "actuators.swrap_follower.blocks" in changes
    page.page.reload()
    page.await_selector("#text-view:not([hidden])")
    assert page.page.input_value("#text") == typed
    page.page.focus("#text")
    page.page.keyboard.press("Tab")
    assert page.run("() => document.activeElement.id") != "text"
    page.page.click("#drop")
    page.page.wait_for_selector("[data-edit][hidden]", state="attached")
    page.close()


def test_wrong_yaml_has_its_line_what_to_do_and_a_way_there(
    chromium, stage: Stage, where: Paths
) -> None:
    page = at_settings(chromium, stage)
    file = turned(page)
    number = file[: file.index("  cycle_ms: 5")].count("\n") + 1
    page.page.fill("#text", file.replace("  cycle_ms: 5", "\tcycle_ms: 5", 1))
    assert "refuses this" in looked(page)
    said = page.text("#text-said")
    assert said.startswith(f"line {number}, column 1")
    assert "YAML takes spaces only: replace it by spaces." in said
    page.page.click("#text-said button")
    assert page.run("() => document.activeElement.id") == "text"
    assert page.text("#text-at") == f"line {number}, column 1"
    page.page.click("#as-form")
    page.page.wait_for_function(
        "() => document.getElementById('work-said').textContent.includes('correct first')"
    )
    assert page.page.is_visible("#text")
    page.page.fill("#text", "")
    assert "the file is empty" in looked(page)
    page.close()


def test_another_persons_save_is_told_and_the_text_goes_on_top(
    chromium, stage: Stage, where: Paths
) -> None:
    page = at_settings(chromium, stage)
    file = turned(page)
    page.page.fill("#text", file.replace("cycle_ms: 5", "cycle_ms: 8", 1) + "# mine\n")
    theirs = "# night shift\n" + file.replace("cycle_ms: 5", "cycle_ms: 10", 1)
    where.site.write_text(theirs, encoding="utf-8")
    page.await_selector("#changed:not([hidden])")
    assert page.page.is_disabled("#edit button[type=submit]")
    page.page.click("#rebase")
    page.page.wait_for_selector("#changed[hidden]", state="attached")
    both = theirs.replace("cycle_ms: 10", "cycle_ms: 8", 1) + "# mine\n"
    assert page.page.input_value("#text") == both
    assert "cycle_ms: 10" in page.text("#clashes")
    assert "line.cycle_ms: 10 ms -> 8 ms (waits for bypass)" in looked(page)
    page.page.click("#drop")
    page.page.wait_for_function("t => document.getElementById('text').value === t", arg=theirs)
    page.close()


@pytest.mark.parametrize("meets", ["a text on its way", "a text that does not come"])
def test_what_is_typed_onto_an_old_text_reverts_nobodys_save(
    chromium, stage: Stage, where: Paths, meets: str
) -> None:
    page = at_settings(chromium, stage)
    file = turned(page)
    held: list[Any] = []

    def hold(route: Any) -> None:
        if meets == "a text on its way":
            held.append(route)
        else:
            route.abort()

    page.page.route("**/settings/text?*", hold)
    theirs = "# night shift\n" + file
    with page.page.expect_request("**/settings/text?*"):  # nothing is pending: the page takes it
        where.site.write_text(theirs, encoding="utf-8")
    page.page.fill("#text", file + "# mine\n")
    page.await_selector("#changed:not([hidden])")
    assert page.page.is_disabled("#edit button[type=submit]")
    for route in held:
        route.continue_()
    page.page.unroute("**/settings/text?*")
    page.page.click("#rebase")
    page.page.wait_for_function(
        "t => document.getElementById('text').value === t", arg=theirs + "# mine\n"
    )
    page.page.wait_for_selector("#changed[hidden]", state="attached")
    assert "# mine" in looked(page)
    assert "-# night shift" not in page.text("#changes")
    page.close()


def test_a_comment_alone_can_be_saved(chromium, stage: Stage, where: Paths) -> None:
    page = at_settings(chromium, stage)
    file = turned(page)
    page.page.fill("#text", file + "# mine\n")
    assert "# mine" in looked(page)
    for name, is_ready in (("try", "no"), ("save", "yes")):
        assert page.page.get_attribute(f"#{name}", "data-ready") == is_ready
    page.close()


def test_edits_outlive_the_page_over_another_persons_limit(
    chromium, stage: Stage, where: Paths
) -> None:
    file = where.site.read_text(encoding="utf-8")
    page = at_settings(chromium, stage)
    soft = page.page.input_value(FIELD)
    page.page.fill(FIELD, "6.5")
    page.page.goto(f"{stage.url}rolls")
    theirs = file.replace("    limit_m_s: 0.04\n", "    limit_m_s: 0.05\n", 1)
    assert theirs != file
    where.site.write_text(theirs, encoding="utf-8")
    for _ in range(2):  # the text that was begun on is remembered, not only that there is an edit
        page.page.goto(f"{stage.url}settings")
        page.await_selector("#changed:not([hidden])")
        assert page.page.input_value(FIELD) == "6.5"
        assert page.page.is_disabled("#edit button[type=submit]")
    page.page.click("#rebase")
    page.page.wait_for_selector("#changed[hidden]", state="attached")
    noted = page.page.locator('.setting[data-path$=".limit_m_s"] .earlier').all_text_contents()
    assert [one for one in noted if one] == ["somebody has changed it meanwhile, from 0.04 m/s"]
    changes = looked(page)
    assert f"{KEY}: {soft} s -> 6.5 s" in changes
    assert "limit_m_s" not in changes
    # what somebody has saved just so is no edit any more, and dropped ones do not come back
    where.site.write_text(theirs.replace(f"soft_start_s: {soft}", "soft_start_s: 6.5", 1))
    page.page.reload()
    page.await_selector("html[data-settings=shown]")
    page.page.wait_for_selector("[data-edit][hidden]", state="attached")
    page.page.fill(FIELD, "7")
    page.page.click("#drop")
    page.page.reload()
    page.await_selector("html[data-settings=shown]")
    assert page.page.input_value(FIELD) == "6.5"
    page.close()
