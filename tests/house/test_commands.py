"""Commands of the pages exist as written; the cheap ones are run, others stand in a table."""

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import tomllib
from functools import cache
from itertools import pairwise

import pytest

from aff_hmi import account_command
from aff_hmi.main import build_parser as screen_parser
from aff_runtime.app.commission import paths
from aff_runtime.cli.main import build_parser as runtime_parser
from aff_runtime.cli.main import main as runtime
from sim_plant.cli.main import build_parser as plant_parser
from tests.aff_runtime.app.judged_here import judged_here
from tests.each_case import each_case
from tests.house.commands import (
    OTHERS,
    OURS,
    Command,
    commands,
    every_command,
    fences,
    inline,
    lines,
    plain,
    split,
)
from tests.house.documents import ROOT, documents, text

TABLE = ROOT / "docs" / "tester" / "commands.md"
RUN = {"aff-runtime check", "aff-runtime", "cp", "mkdir", "sed", "cd"}
RUN |= {f"aff-runtime card {word}" for word in ("new", "step", "sign", "show", "page", "verify")}
"""What `test_cheap_commands_do_what_the_page_says` runs as it stands."""

COMMANDS = every_command()
_ROW = re.compile(r"^\| `([^`]+)` \| ([^|]+) \| (?:\[[^]]*\]\(([^)]+)\))? ?\|$", re.MULTILINE)
ROWS = {key: (needs, test) for key, needs, test in _ROW.findall(text(TABLE))}
MAKEFILE = text(ROOT / "Makefile")
TARGETS = set(re.findall(r"^([a-z][\w-]*):", MAKEFILE, re.MULTILINE))
VARIABLES = set(re.findall(r"^([A-Z]+) *\?=", MAKEFILE, re.MULTILINE))
VARIABLES |= set(re.findall(r"\$\((?:if )?\$?\(?([A-Z]+)\)", MAKEFILE))
MADE_BY_MAKE = (
    "out/demo-modbus/",
    "out/release/",
    ".venv/",
    "aff_runtime-",
)  # demo, setup, release
OUTPUTS = {"--out", "--record-dir", "--control", "--channel", "--accounts", "mkdir", ">"}


@cache
def parser(program):
    """Return the real parser of a program."""
    made = {"aff-runtime": runtime_parser, "sim-plant": plant_parser, "aff-hmi": screen_parser}
    return made[program]()


def refusal(program, words):
    """Return what a program's parser says against words, or nothing."""
    asked = parser(program)
    if program == "aff-hmi" and words[:1] == ["account"]:
        asked, words = account_command._parser(), words[1:]
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            asked.parse_args(words)
        except SystemExit as end:
            return said.getvalue() if end.code else ""
    return ""


def unknown_for_make(words):
    """Return the words that the Makefile does not know."""
    names = [word.partition("=")[0] for word in words if "=" in word]
    targets = [word for word in words if "=" not in word and not word.startswith("-")]
    return [name for name in names if name not in VARIABLES] + [
        target for target in targets if target not in TARGETS
    ]


@each_case("command", COMMANDS)
def test_a_command_is_taken_by_its_program(command):
    words = plain(command.without_sudo())
    if words[0] == "make":
        assert unknown_for_make(words[1:]) == []
    elif words[0] in OURS:
        assert refusal(words[0], words[1:]) == ""
    elif command.key == "install.sh":
        known = re.findall(r"^ +(?:-h \| )?(--[a-z-]+)\)", text(ROOT / "deploy/install.sh"), re.M)
        assert set(words[1:]) <= set(known)
    elif words[:2] == ["pip", "install"]:
        extras = tomllib.loads(text(ROOT / "pyproject.toml"))["project"]["optional-dependencies"]
        asked = ",".join(one for word in command.words for one in re.findall(r"\[(.*)\]", word))
        assert set(asked.split(",")) <= set(extras)
    else:
        assert words[0] in {*OTHERS, "systemctl"}, "not known here: tests/house/commands.py"


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_a_command_in_running_text_has_its_name_and_its_options(path):
    wrong = []
    for command in inline(path):
        program, words = command.words[0], plain(command.words[1:])
        if program == "make":
            wrong += [f"{command}: {word}" for word in unknown_for_make(words)]
            continue
        # words that stand for others may be missing; a wrong name or option is refused as such
        said = refusal(program, words)
        if re.search(r"invalid choice|unrecognized arguments", said) and "metavar" not in said:
            wrong.append(f"{command}: {said.splitlines()[-1]}")
    assert wrong == []


def placeholder(word):
    """Whether a word stands for one of the reader's own: a part of it is in capitals."""
    return any(re.search(r"[A-Z]{3}", part) for part in re.split(r"[/.@=]", word))


def unmade_files(taken):
    """Return the files that commands of a page name, and that nothing has made."""
    made, wrong = set(MADE_BY_MAKE), []
    for command in taken:
        words = plain(command.without_sudo())
        fresh = {after for word, after in pairwise(words) if word in OUTPUTS}
        fresh |= set(words[1:]) if words[0] == "mkdir" else set()
        fresh |= {words[-1]} if words[0] == "cp" else set()
        fresh |= {"card.html", "card.jsonl"} if "card" in words[1:2] else set()
        for word in words[1:]:
            name = word.partition("@")[0].rstrip(";")
            if word in fresh or not re.fullmatch(r"[\w.*/-]+", name) or placeholder(word):
                continue
            if not re.search(r"/|\.(?:yaml|html|jsonl|txt|sh|csv|dbc|eds|gz)$", name):
                continue
            if name.startswith(("/", "127.")) or re.search(r"\.pem$", name):
                continue
            if not (list(ROOT.glob(name)) or any((name + "/").startswith(one) for one in made)):
                wrong.append(f"{command}: {name}")
        made |= fresh
    return wrong


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_files_that_commands_name_are_there_or_made_before(path):
    assert unmade_files(commands(path)) == []


@each_case("command", COMMANDS)
def test_a_command_is_run_here_or_is_in_the_table_of_those_that_need_more(command):
    assert (command.key in RUN) != (command.key in ROWS), f"{command.key}: see {TABLE.name}"


def test_the_table_names_no_command_that_no_page_has():
    keys = {command.key for command in every_command()}
    assert sorted(set(ROWS) - keys) == []
    assert len(ROWS) == text(TABLE).count("\n| `")


@each_case("key", ROWS)
def test_the_tests_of_the_table_speak_of_the_command(key):
    test = ROWS[key][1]
    if test:
        found = text((TABLE.parent / test).resolve())
        word = key.split()[-1].removeprefix("aff-").removesuffix(".sh")
        assert re.search(rf"\b{word.replace('-', '.')}", found), f"{test} says nothing of {word}"


@each_case("path", documents(), ids=lambda p: str(p.relative_to(ROOT)))
def test_a_block_says_what_language_it_is_in(path):
    for language, block in fences(path):
        assert language, block[:60]
        first = [row.split()[0] for row in block.splitlines() if row.split()]
        assert language == "sh" or not set(first) & {*OURS, "sudo", "pip"}, block[:60]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder with the repository's files, as a reader has it."""
    (tmp_path / "config").symlink_to(ROOT / "config")
    shutil.copy(ROOT / "config" / "euclid.yaml", tmp_path / "SITE.yaml")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return tmp_path


def shell(line):
    """Run a line of a shell that holds no command of ours."""
    done = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=False)
    assert done.returncode == 0, (line, done.stderr)


def follow(page, *, instead=()):
    """Run the cheap commands of a page, in their order; return those of ours with their codes."""
    codes = {}
    for language, block in fences(page):
        for row in lines(block) if language == "sh" else []:
            for before, after in instead:
                row = row.replace(before, after)  # noqa: PLW2901
            asked = [Command(page, words) for words in split(row)]
            if asked[0].program in ("cp", "mkdir", "sed"):
                shell(row)
            for one in asked:
                if one.program == "cd":
                    os.chdir(one.words[1])
                elif one.program == "aff-runtime" and one.key in RUN:
                    words = one.without_sudo()
                    codes[shlex.join(words)] = runtime(list(words[1:]))
    return codes


def test_the_tutorials_site_file_is_made_and_right(folder):
    codes = follow(ROOT / "docs" / "tutorial.md")
    assert codes == {"aff-runtime check out/tutorial/site.yaml": 0}


def test_the_runbooks_check_passes(folder):
    codes = follow(ROOT / "deploy" / "RUNBOOK.md", instead=[("/etc/aff-runtime/site", "SITE")])
    assert codes == {"aff-runtime check SITE.yaml": 0}


def test_the_site_file_that_the_can_page_makes_is_right_and_needs_no_adapter(folder):
    follow(ROOT / "docs" / "technician" / "can.md")
    made = folder / "home" / "aff" / "euclid_can.yaml"
    assert "interface: frame_socket" in text(made)
    assert runtime(["check", str(made), "--brief"]) == 0


def test_the_card_page_makes_a_card_that_verifies(folder, capsys, monkeypatch):
    monkeypatch.setattr(paths, "load_parameters", judged_here)
    site = [("SITE.yaml", str(folder / "SITE.yaml"))]
    codes = follow(ROOT / "docs" / "technician" / "card.md", instead=site)
    assert [code for code in codes.values() if code != 0] == []
    assert len(codes) == 6
    assert (folder / "CARD_DIR" / "card.html").exists()
    assert "Ada Miller" in capsys.readouterr().out


def test_the_version_names_the_release(capsys):
    with pytest.raises(SystemExit) as end:
        runtime(["--version"])
    assert (end.value.code, "law by" in capsys.readouterr().out) == (0, True)


def test_a_wrong_option_command_target_or_file_is_found():
    assert "unrecognized" in refusal("aff-runtime", ["arm", "--now"])
    assert "invalid choice" in refusal("sim-plant", ["server"])
    assert refusal("aff-hmi", ["account", "add", "anna", "--role", "king", "--accounts", "a"])
    assert unknown_for_make(["demo", "SPED=3", "dmo"]) == ["SPED", "dmo"]
    rows = split("cp config/nothing.yaml out/a.yaml; aff-runtime check out/a.yaml; ls out/b.yaml")
    unmade = unmade_files([Command(ROOT / "page.md", words) for words in rows])
    assert [row.rpartition(": ")[2] for row in unmade] == ["config/nothing.yaml", "out/b.yaml"]


def test_split_knows_comments_quotes_and_ends():
    assert split("aff-runtime arm && aff-runtime top   # ctrl-c leaves") == [
        ("aff-runtime", "arm"),
        ("aff-runtime", "top"),
    ]
    assert split("a --why 'x; y' & b; c") == [("a", "--why", "x; y"), ("b",), ("c",)]
