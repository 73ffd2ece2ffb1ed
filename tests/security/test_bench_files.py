"""Files that the bench puts in place or takes away, and words that it draws."""

from __future__ import annotations

import asyncio
import os
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from aff_runtime.base.errors import AffError
from sim_plant.base.svg import as_written, svg
from sim_plant.cli.main import main
from sim_plant.cli.output import say
from sim_plant.demo.plots import block_plot
from sim_plant.demo.roll_plot import LearnedOrder, roll_plot
from sim_plant.refine.report.folder import FILES, FRESH, check_folder, publish
from sim_plant.refine.report.outcome import RefineRequest
from sim_plant.refine.report.plots import overlay, spectrum, wavenumber_map
from sim_plant.refine.spectra.spectral_lines import SpectralLines
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.frame_hub import FrameHub

pytestmark = pytest.mark.processes

LINE = Path("config/lines/euclid.yaml")


@pytest.fixture
def short(tmp_path, monkeypatch):
    """Work in a folder whose sockets have short names."""
    monkeypatch.chdir(tmp_path)
    return Path("s")


async def _opened(path, kind):
    if kind == "channel":
        hub = FrameHub(path)
        hub.open(lambda _: None)
        hub.close()
    else:
        control = ControlSocket(path, None, dict)
        await control.open()
        await control.close()
        await asyncio.sleep(0)  # the loop lets go of what was closed


@pytest.mark.parametrize("kind", ["channel", "control"])
@pytest.mark.parametrize("there", ["file", "link", "dangling", "folder", "pipe"])
def test_what_lies_where_a_socket_goes_is_not_taken_away(short, kind, there):
    other = Path("mine")
    if there == "file":
        short.write_text("mine")
    elif there == "folder":
        short.mkdir()
    elif there == "pipe":
        os.mkfifo(short)
    else:
        other.write_text("mine")
        short.symlink_to(other if there == "link" else "gone")
    with pytest.raises(AffError, match="s: "):
        asyncio.run(_opened(short, kind))
    assert os.path.lexists(short)
    assert there != "file" or short.read_text() == "mine"
    assert there != "link" or other.read_text() == "mine"


@pytest.mark.parametrize("kind", ["channel", "control"])
def test_a_socket_that_was_left_behind_is_replaced(short, kind):
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as left:
        left.bind(str(short))
    asyncio.run(_opened(short, kind))
    assert not short.exists()


def plan(out):
    return RefineRequest(out=out, line=out.parent / "line.yaml", records=(), holdout=())


@pytest.mark.parametrize("name", FILES)
def test_a_link_in_place_of_a_result_is_replaced_and_not_followed(tmp_path, name):
    out, other = tmp_path / "out", tmp_path / "theirs"
    out.mkdir()
    other.write_text("theirs")
    (out / name).symlink_to(other)
    publish(plan(out), lambda into: (into.out / name).write_text("new") and None)
    assert other.read_text() == "theirs"
    assert (out / name).read_text() == "new"
    assert not (out / name).is_symlink()


def test_a_link_that_looks_like_the_rest_of_a_run_is_not_followed(tmp_path):
    out, other = tmp_path / "out", tmp_path / "theirs"
    out.mkdir()
    other.mkdir()
    (other / "kept").write_text("theirs")
    (out / f"{FRESH}x").symlink_to(other)
    publish(plan(out), lambda into: (into.out / FILES[0]).write_text("new") and None)
    assert (other / "kept").read_text() == "theirs"


@pytest.mark.parametrize("where", ["loop", "file", "/proc/self", "/dev/null/out", "file/out"])
def test_a_folder_that_is_none_is_refused_in_words(tmp_path, monkeypatch, where):
    monkeypatch.chdir(tmp_path)
    Path("loop").symlink_to("loop")
    Path("file").write_text("mine")
    made = replace(plan(tmp_path / "out"), out=Path(where))

    def write():
        check_folder(made)
        publish(made, lambda into: (into.out / FILES[0]).write_text("new") and None)

    with pytest.raises(AffError, match=f"--out {where}: "):
        write()
    assert Path("file").read_text() == "mine"


def test_a_word_of_a_file_is_no_formula_in_any_plot():
    """A formula of 2000 levels ends matplotlib's reader of formulas by recursion."""
    word = "$" + "{" * 2000 + "}" * 2000 + "$"
    rows = np.sin(0.1 * np.arange(4000)).reshape(1, -1)
    judged = SimpleNamespace(
        channels=[word],
        measured=rows,
        declared=0.5 * rows,
        amended=0.9 * rows,
        rms_declared=np.ones(1),
        floor=np.ones(1),
        first=0,
        travel_m=0.01 * np.arange(4000.0),
    )
    line = SpectralLines(
        axis="angle",
        roll=word,
        frequency=np.arange(1.0, 50.0),
        chi2_reduction=np.arange(1.0, 50.0),
        degrees=2,
    )
    columns = {"time_s": np.arange(9.0), f"{word}.amplitude_m_s": np.arange(9.0)}
    learned = [
        LearnedOrder(actuator=word, roll=word, order=k, deviation_mm=1.0, angle_deg=0.0)
        for k in range(1, 9)
    ]
    drawn = (
        *overlay(judged, 0.01, slice(None)),
        spectrum([line], [line], 100.0),
        *wavenumber_map(judged, 0.01),
        block_plot(columns),
        roll_plot(learned),
    )
    assert all(page.startswith("<svg") for page in drawn)


@pytest.mark.parametrize(
    ("word", "drawn"),
    [
        ("5 $ and 6 $", "5 $ and 6 $"),
        (r"$\frac{1}{$", r"$\frac{1}{$"),
        (r"\$x\$", r"\$x\$"),
        ("a\x1b\n\u202e", r"a\x1b\n\u202e"),
        ("<b>&", "&lt;b&gt;&amp;"),
        ("x" * 90, "x" * 77 + "..."),
    ],
)
def test_a_word_is_drawn_as_it_is_written(word, drawn):
    figure = Figure()
    figure.text(0.1, 0.1, as_written(word))
    assert f">{drawn}</text>" in svg(figure, letters=True)


def test_words_of_files_do_nothing_on_the_terminal(capsys, tmp_path):
    say("verdict:\n  a\x1b[2J\rb\u202e\u2028c")
    assert capsys.readouterr().out == "verdict:\n  a\\x1b[2J\\rb\\u202e\\u2028c\n"
    record = tmp_path / "r\x1b[2J.csv"
    record.write_text("time_s,x\x1b[31m_N\n" + "0.01,open\n" * 200)
    assert main(["refine", str(LINE), str(record), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.isascii()
    assert said.rstrip("\n").isprintable()


def test_a_matplotlibrc_of_the_working_folder_does_not_say_how_figures_are_drawn(tmp_path):
    """It could have every word set by TeX, which reads files; here it would find no TeX."""
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\ntext.latex.preamble: \\input{/x}\n")
    program = (
        "from sim_plant.base.svg import svg; from matplotlib.figure import Figure; "
        "figure = Figure(); figure.text(0.1, 0.1, 'a'); print(svg(figure)[:4])"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout == "<svg\n", done.stderr
