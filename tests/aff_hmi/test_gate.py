"""What a request must be to reach a page, and what every answer carries."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import pytest

pytest.importorskip("starlette")

from aff_hmi.bundles import FOLDER, PAGES, STATIC, STYLES, VENDORED, joined, served, source
from aff_hmi.gate import BURST, HEADERS, MAX_ADDRESSES, Rates
from aff_hmi.layout import layout_of
from tests.aff_hmi.asgi import HOST, get, screen, shake
from tests.aff_hmi.moments import facts
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case

FILES = served(has_hand=False)
OWN = [("host", HOST), ("origin", f"http://{HOST}")]


@pytest.fixture
def app(tmp_path: Path):
    return screen(tmp_path, VirtualClock(1))[0]


@pytest.mark.parametrize("path", ["/", "/metrics", *(f"/static/{name}" for name in FILES)])
def test_every_page_has_the_headers(app, path: str) -> None:
    answer = get(app, path)
    assert answer.status == 200
    for name, value in HEADERS.items():
        assert answer.headers[name] == value
    assert "set-cookie" not in answer.headers


@pytest.mark.parametrize("path", ["/nothing", "/static/nothing", "/static/..%2fgate.py", "/docs"])
def test_what_is_no_route_is_404_with_the_headers(app, path: str) -> None:
    answer = get(app, path)
    assert answer.status == 404
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_nothing_may_run_that_is_not_a_file_of_ours() -> None:
    policy = HEADERS["content-security-policy"]
    assert "unsafe" not in policy
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert not re.search(r"https?:|\*", policy)


@pytest.mark.parametrize(
    "method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT"]
)
@pytest.mark.parametrize("path", ["/", "/live", "/static/overview.js", "/arm"])
def test_nothing_but_looking_is_answered(app, method: str, path: str) -> None:
    assert get(app, path, method).status == 405


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:8481",
        "127.0.0.1:8480.evil.example",
        "127.0.0.1:8480@evil.example",
        "",
        "localhost:8480\u00e4",
    ],
)
def test_a_name_that_is_not_ours_is_refused(app, host: str) -> None:
    answer = get(app, headers=[("host", host)])
    assert answer.status == 421
    assert "Euclid" not in answer.body
    assert host not in answer.body or not host


def test_no_host_and_two_hosts_are_refused(app) -> None:
    assert get(app, headers=[]).status == 421
    assert get(app, headers=[("host", HOST), ("host", "evil.example")]).status == 421


def test_a_name_in_capitals_is_the_same_name(tmp_path: Path) -> None:
    app, _ = screen(tmp_path, VirtualClock(1))
    assert get(app, headers=[("HOST", HOST.upper())]).status == 200


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        f"https://{HOST}",
        "http://127.0.0.1:1",
        f"http://{HOST}.x",
        "",
    ],
)
def test_a_socket_of_another_origin_is_refused(app, origin: str) -> None:
    (said,) = shake(app, [("host", HOST), ("origin", origin)])
    assert said == {"type": "websocket.close", "code": 1008}


def test_a_socket_without_origin_or_with_two_is_refused(app) -> None:
    assert shake(app, [("host", HOST)])[0]["type"] == "websocket.close"
    assert shake(app, [*OWN, ("origin", "http://evil.example")])[0]["type"] == "websocket.close"


def test_a_socket_of_our_own_page_is_taken(app) -> None:
    assert shake(app, OWN)[0]["type"] == "websocket.accept"


def test_only_one_path_has_a_socket(app) -> None:
    assert shake(app, OWN, "/other")[0]["type"] == "websocket.close"


def test_a_flood_is_told_to_wait_and_heard_again_after_a_second(tmp_path: Path) -> None:
    clock = VirtualClock(1)
    app, _ = screen(tmp_path, clock)
    codes = [get(app, "/static/icon.svg").status for _ in range(int(BURST) + 5)]
    assert codes == [200] * int(BURST) + [429] * 5
    assert shake(app, OWN)[0]["type"] == "websocket.close"
    clock.advance_ns(1_000_000_000)
    assert get(app).status == 200


def test_addresses_are_not_remembered_without_end() -> None:
    rates = Rates(VirtualClock(1))
    assert all(rates.allows(str(n)) for n in range(3 * MAX_ADDRESSES))
    assert len(rates._buckets) == MAX_ADDRESSES


def test_with_tls_the_browser_is_told_to_stay_there_and_at_loopback_beside_it_is_not(
    tmp_path: Path,
) -> None:
    app, _ = screen(tmp_path, VirtualClock(1))
    assert get(app, is_tls=True).headers["strict-transport-security"].startswith("max-age=")
    assert "strict-transport-security" not in get(app).headers
    tls = [("host", HOST), ("origin", f"https://{HOST}")]
    assert shake(app, tls, is_tls=True)[0]["type"] == "websocket.accept"
    assert shake(app, tls)[0]["type"] == "websocket.close"
    assert shake(app, OWN, is_tls=True)[0]["type"] == "websocket.close"


HOSTILE = "<img src=x onerror=alert(1)>\"'&\u202e{{7*7}}"


def test_a_hostile_name_is_text_on_the_page(tmp_path: Path) -> None:
    app, hub = screen(tmp_path, VirtualClock(1))
    said = facts(line=HOSTILE)
    hub.layout = layout_of(said, ("unwind_tension_N", f"{HOSTILE}_tension_N", "line_speed_m_s"))
    page = get(app).body
    assert "<img" not in page
    assert "&lt;img src=x onerror=alert(1)&gt;" in page
    shown = re.sub(r"<[^>]*>", "", page)
    assert "\u202e" not in shown
    assert "{{7*7}}" in shown


@pytest.mark.parametrize("language", ["en", "de"])
def test_a_page_asks_for_nothing_off_the_host(app, language: str) -> None:
    page = get(app, f"/?lang={language}").body
    assert f'lang="{language}"' in page
    assert not re.search(r"""(src|href)=["'](?!/)(?!#)""", page)
    assert not re.search(r"\son\w+=|\sstyle=|javascript:", page)
    for path in (*STATIC.iterdir(), *VENDORED.values()):
        text = path.read_text()
        assert not re.search(r"@import|url\(|\beval\b|Function\(|innerHTML|insertAdjacent", text)
        if path not in VENDORED.values():  # no box stands before the bypass
            assert not re.search(r"showModal|\b(alert|confirm|prompt)\(", text)
        if path in VENDORED.values():  # its own address stands in its head
            continue
        found = re.findall(r"https?://[^\s\"']+", text)
        assert [one for one in found if "w3.org" not in one] == []


@each_case("page", PAGES)
def test_script_and_style_of_a_page_are_small(page: str) -> None:
    """Its own: 53 kB of uPlot come beside it where there are charts."""
    files = served(has_hand=True)
    assert sum(len(files[name][0]) for name in (f"{page}.js", "screen.css")) < 110_000


@pytest.mark.parametrize("has_hand", [False, True])
def test_every_file_of_ours_is_in_what_is_served_once_and_no_name_is_taken_from_outside(
    has_hand: bool,
) -> None:
    files = served(has_hand=has_hand)
    scripts = {f"{page}.js": files[f"{page}.js"][0].decode() for page in PAGES}
    style = files["screen.css"][0].decode()
    for path in STATIC.glob("*.css"):
        assert path.read_text() in style
        assert path.name in STYLES
    for text in scripts.values():
        assert not re.search(r"^\s*(import|export)\b", text, re.MULTILINE)
        assert len(re.findall(r"^// ([a-z]+\.js)$", text, re.MULTILINE)) == len(
            set(re.findall(r"^// ([a-z]+\.js)$", text, re.MULTILINE))
        )
    used = {
        name for text in scripts.values() for name in re.findall(r"^// (\w+\.js)$", text, re.M)
    }
    of_hand = set() if has_hand else {"hand.js"}
    assert used == {path.name for path in STATIC.glob("*.js")} - of_hand


def test_a_joined_module_comes_after_those_that_it_takes_names_from() -> None:
    text = joined(("scope.js",))
    places = [
        text.index(f"// {name}")
        for name in ("see.js", "curves.js", "picture.js", "readout.js", "scope.js")
    ]
    assert places == sorted(places)
    assert "return { byId, words, put, part, number, at, ask, press, send, onPart };" in text
    assert "const { css, look, short } = of_curves;" in text
    assert text.count(source("see.js").splitlines()[0]) == 1


def test_what_is_of_others_is_what_they_published_with_its_licence() -> None:
    folder = FOLDER / "vendored"
    said = dict(line.split()[::-1] for line in (folder / "SHA256SUMS").read_text().splitlines())
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "SHA256SUMS"]
    assert {str(path.relative_to(folder)) for path in files} == set(said)
    for path in files:
        found = hashlib.sha256(path.read_bytes()).hexdigest()
        assert found == said[str(path.relative_to(folder))]
    for path in VENDORED.values():
        assert "MIT" in (path.parent / "LICENSE").read_text()
