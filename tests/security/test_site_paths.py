"""A site file reads, writes and clears away nothing outside its own folder and the state's."""

from __future__ import annotations

from pathlib import Path
from typing import cast

import pytest

from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.runtime_directory import runtime_paths
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.cli.main import build_parser, main
from aff_runtime.config.check import check_site
from aff_runtime.config.loader import load_site
from aff_runtime.config.site_paths import STATE_DIRECTORY, named
from tests.aff_runtime.app.judged_here import judged_here
from tests.aff_runtime.config.shipped import copied

ROOT = Path(__file__).parents[2]
SECRET = "root:*:20228:0:99999:7:::\n"
TLS = "    tls: { ca: ca.pem, certificate: aff.pem, private_key: aff.key, crl: crl.pem }"
# Every key that names a file or folder: in which shipped site, and what stands there.
KEYS = {
    "gateway.modbus_tcp.tls.ca": ("euclid.yaml", "ca.pem"),
    "gateway.modbus_tcp.tls.certificate": ("euclid.yaml", "aff.pem"),
    "gateway.modbus_tcp.tls.private_key": ("euclid.yaml", "aff.key"),
    "gateway.modbus_tcp.tls.crl": ("euclid.yaml", "crl.pem"),
    "gateway.can_dbc.dbc": ("euclid_can.yaml", "euclid.dbc"),
    "gateway.canopen_402.nodes.line.eds": ("euclid_canopen.yaml", "euclid_line.eds"),
    "actuators.unwind.response": ("euclid.yaml", "learned/euclid_unwind.json"),
    "recording.directory": ("euclid.yaml", "runs"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A site's folder, and beside it one that is none of its business."""
    (tmp_path / "site").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "secret").write_text(SECRET)
    folder = cast(Path, copied(tmp_path / "site"))
    path = folder / "euclid.yaml"
    path.write_text(path.read_text().replace("    port: 5020", f"    port: 5020\n{TLS}", 1))
    return folder


def refused(path: Path, key: str, *options: str) -> str:
    """Return the one finding on a key."""
    report = check_site(path, (), Path(options[0]) if options else STATE_DIRECTORY)
    (finding,) = [finding for finding in report.errors if finding.path == key]
    return str(finding)


def test_the_keys_are_all_that_a_site_has(folder: Path) -> None:
    def shown(name: str) -> set[str]:
        site = load_site(ROOT / "config" / name)
        return {".".join(map(str, path)) for path, _ in named(site)}

    found = shown("euclid_can.yaml") | shown("euclid_canopen.yaml")
    found |= {key for key in KEYS if ".tls." in key}
    others = {"gateway.canopen_402.nodes.unwind.eds", "actuators.swrap_follower.response"}
    assert {key for key in found - KEYS.keys() if not key.endswith(".eds")} <= others
    assert found >= KEYS.keys()


@pytest.mark.parametrize("way", ["above", "absolute", "a link", "a link on the way"])
@pytest.mark.parametrize("key", KEYS)
def test_a_name_that_leads_out_is_refused_and_not_read(folder: Path, key: str, way: str) -> None:
    name, written = KEYS[key]
    path, target = folder / name, folder.parent / "elsewhere" / "secret"
    text = path.read_text()
    assert written in text
    new = written
    if way == "above":
        new = "../elsewhere/secret"
    elif way == "absolute":
        new = str(target)
    elif way == "a link":
        (folder / written).parent.mkdir(exist_ok=True)
        (folder / written).unlink(missing_ok=True)
        (folder / written).symlink_to(target)
    else:
        new = "way/secret"
        (folder / "way").symlink_to(target.parent)
    place = text.rindex(written) if key == "recording.directory" else text.index(written)
    path.write_text(text[:place] + new + text[place + len(written) :])
    said = refused(path, key)
    assert said.startswith(f"{path}:")
    assert f"{new} leads to {target}, which is not below {folder}" in said
    everything = "\n".join(check_result(path).findings)
    assert "root:" not in everything
    assert "20228" not in everything


def test_a_link_in_the_place_of_the_learned_shape_is_refused_too(folder: Path) -> None:
    target = folder.parent / "elsewhere" / "secret"
    (folder / "learned").mkdir()
    (folder / "learned" / "euclid_can_unwind.shape.json").symlink_to(target)
    assert f"leads to {target}" in refused(folder / "euclid_can.yaml", "actuators.unwind.response")


@pytest.mark.parametrize("name", [".", "/", "..", "learned/..", "learned/../../x"])
def test_odd_names_of_a_response_are_no_crash(folder: Path, name: str) -> None:
    path = folder / "euclid_can.yaml"
    path.write_text(path.read_text().replace("learned/euclid_can_unwind.json", name))
    said = check_result(path)
    assert said.parameters is None
    assert any("actuators.unwind.response: " in line for line in said.findings)


def test_links_that_go_in_circles_lead_nowhere(folder: Path) -> None:
    (folder / "euclid.dbc").unlink()
    (folder / "euclid.dbc").symlink_to("euclid.dbc")
    assert "cannot be read" in refused(folder / "euclid_can.yaml", "gateway.can_dbc.dbc")


def test_names_inside_are_taken_whichever_way_they_are_written(folder: Path) -> None:
    (folder / "wires").mkdir()
    (folder / "euclid.dbc").rename(folder / "wires" / "euclid.dbc")
    (folder / "linked.dbc").symlink_to("wires/euclid.dbc")
    path = folder / "euclid_can.yaml"
    text = path.read_text()
    for name in ("wires/euclid.dbc", str(folder / "wires" / "euclid.dbc"), "linked.dbc"):
        path.write_text(text.replace("dbc: euclid.dbc", f"dbc: {name}"))
        assert load_site(path)


def test_a_site_behind_a_link_has_the_folder_of_the_link(folder: Path) -> None:
    other = folder.parent / "etc"
    other.symlink_to(folder)
    assert load_site(other / "euclid_can.yaml")


def test_the_layout_of_the_installer_is_taken(folder: Path) -> None:
    """``/etc/aff-runtime/learned`` is a link into the state's folder."""
    state = folder.parent / "var" / "lib" / "aff-runtime"
    (state / "learned").mkdir(parents=True)
    (folder / "learned").symlink_to("../var/lib/aff-runtime/learned")
    path = folder / "euclid_can.yaml"
    assert "leads to" in refused(path, "actuators.unwind.response")
    assert load_site(path, state)
    assert judged_here(path, state).parameters is not None
    assert main(["check", str(path), "--state-dir", str(state), "--brief"]) == 0
    assert main(["check", str(path), "--brief"]) == 2


def test_the_state_folder_is_the_one_that_the_unit_and_the_installer_make() -> None:
    unit = (ROOT / "deploy" / "aff-runtime.service").read_text()
    assert Path("/var/lib") / "aff-runtime" == STATE_DIRECTORY
    assert "StateDirectory=aff-runtime" in unit.splitlines()
    assert "state=$prefix/var/lib/aff-runtime" in (ROOT / "deploy" / "install.sh").read_text()


@pytest.mark.parametrize("command", ["run", "check", "probe", "map", "probe-map"])
def test_every_command_that_takes_a_site_takes_the_state_folder(command: str) -> None:
    parsed = build_parser().parse_args([command, "site.yaml", "--state-dir", "/srv/state"])
    assert parsed.state_dir == Path("/srv/state")
    assert build_parser().parse_args([command, "site.yaml"]).state_dir == STATE_DIRECTORY


def test_the_folder_of_records_may_be_any_that_the_command_line_names(folder: Path) -> None:
    path = folder / "euclid_can.yaml"
    text = path.read_text()
    elsewhere = folder.parent / "elsewhere"
    path.write_text(text.replace("directory: runs", f"directory: {elsewhere}"))
    said = refused(path, "recording.directory")
    assert f"start the service with --record-dir {elsewhere}" in said
    path.write_text(text)
    options = RunOptions(site=path, paths=runtime_paths(folder / "rt"), record_directory=elsewhere)
    assert judged_here(path, options.state_directory).parameters is not None
