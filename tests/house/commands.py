"""The shell commands of the documents, taken apart."""

import re
import shlex
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.house.documents import ROOT, documents, text

OURS = ("aff-runtime", "sim-plant", "aff-hmi", "make")
OTHERS = (
    *("mkdir", "cp", "sed", "cd", "ls", ".", "pip", "sudo", "sudoedit", "tar", "sha256sum"),
    *("gpg", "ssh-keygen", "dask", "docker", "cc"),
)
SUBCOMMANDS_OF = {"card", "settings", "watch", "audit", "account"}
"""Words that have commands of their own below them."""

_FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"`((?:aff-runtime|sim-plant|aff-hmi|make) [^`\n]+)`")
_END = {"&&", ";", "|", "||", "&"}


@dataclass(frozen=True)
class Command:
    """One command of a page, as words."""

    page: Path
    words: tuple[str, ...]

    @property
    def program(self):
        """Its program, without ``sudo`` and its user."""
        return self.without_sudo()[0]

    @property
    def key(self):
        """The program and what it is asked for: ``aff-runtime settings try``."""
        words = self.without_sudo()
        if words[0] not in OURS:
            return Path(words[0]).name if "/" in words[0] else words[0]
        plain = [word for word in words[1:] if not word.startswith("-")]
        if not plain or (words[0] == "aff-hmi" and words[1].startswith("-")):
            return words[0]
        below = plain[0] in SUBCOMMANDS_OF and len(plain) > 1
        return " ".join([words[0], *plain[: 2 if below else 1]])

    def without_sudo(self):
        """Return the words behind ``sudo [-u USER]``."""
        words = self.words
        if words[0] != "sudo":
            return words
        return words[3:] if words[1] == "-u" else words[1:]

    def __str__(self):
        return f"{self.page.relative_to(ROOT)}: {shlex.join(self.words)}"


def fences(path):
    """Return a document's fenced blocks: language and text."""
    return _FENCE.findall(text(path))


def split(line):
    """Return the commands of one line of a shell, each as its words; redirections stay in them."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    lexer.commenters = "#"
    found, words = [], []
    for word in lexer:
        if word in _END:
            found.append(tuple(words))
            words = []
        else:
            words.append(word)
    return [one for one in [*found, tuple(words)] if one]


def lines(block):
    """Return the lines of a block, with continued ones joined."""
    return [row for row in block.replace("\\\n", " ").splitlines() if row.strip()]


@cache
def commands(path):
    """Return every command of a document's blocks of shell, in their order."""
    blocks = [block for language, block in fences(path) if language == "sh"]
    rows = [row for block in blocks for row in lines(block)]
    return tuple(Command(path, words) for row in rows for words in split(row))


@cache
def every_command():
    """Return every command of every document."""
    return tuple(command for path in documents() for command in commands(path))


def inline(path):
    """Return the commands of ours that stand in a document's running text, as words.

    An ellipsis, or a word that is no word of a shell, ends what is taken of one.
    """
    prose = _FENCE.sub("", text(path))
    found = []
    for written in _INLINE.findall(prose):
        rest = re.split(r"[|\\]|\.\.\.|‹", written)[0]
        try:
            found += [Command(path, words) for words in split(rest) if words[0] in OURS]
        except ValueError:  # a quotation mark that the page closes elsewhere
            found.append(Command(path, tuple(rest.split()[:2])))
    return found


def plain(words):
    """Return words without the marks of a synopsis: brackets and ellipses."""
    bare = [word.replace("[", "").replace("]", "").replace("...", "") for word in words]
    return [word for word in bare if word]
