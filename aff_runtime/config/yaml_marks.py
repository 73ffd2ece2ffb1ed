"""Strict YAML that remembers where everything stood.

PyYAML composes the node tree; the values are made here, so that nothing YAML 1.1 does silently
(base 60, octal, yes/no as booleans, last duplicate wins, dates) reaches the models unseen.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

import yaml

from aff_runtime.base.units import plain
from aff_runtime.base.yaml_places import Bounds, Fault, YamlTextError, compose, line_and_column
from aff_runtime.config.findings import Finding, KeyPath, SiteFileError, dotted
from aff_runtime.config.plain_file import TooLargeError, read_plain

Tree: TypeAlias = "dict[str, Tree] | tuple[Tree, ...] | str | int | float | bool | None"

MAX_BYTES = 256 * 1024
MAX_DEPTH = 20
MAX_NODES = 20_000
BOUNDS = Bounds(depth=MAX_DEPTH, events=MAX_NODES)

_TAG = "tag:yaml.org,2002:"
_PLAIN_INT = re.compile(r"[-+]?(0|[1-9][0-9]{0,18})|0x[0-9a-fA-F]{1,8}")
_PLAIN_FLOAT = re.compile(r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+)([eE][-+][0-9]+)?")
_BOOLEANS = {"true": True, "yes": True, "on": True, "false": False, "no": False, "off": False}
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
_AFTER_COMMA = re.compile(r"[0-9]+([eE][-+]?[0-9]+)?( .*)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Where a value and its key stand (from 1), and what was written."""

    line: int
    column: int
    key_line: int
    key_column: int
    written: str


@dataclass(frozen=True, slots=True, kw_only=True)
class MarkedTree:
    """A file's values, with the mark of each by its path; ``()`` is the file itself.

    ``raw``: the bytes that were parsed.
    """

    file: str
    values: dict[str, Tree]
    marks: dict[KeyPath, Mark]
    raw: bytes = b""

    def finding(self, path: KeyPath, text: str, *, at_key: bool = False) -> Finding:
        """Return a finding at ``path``, or at its nearest section that stands in the file."""
        known = path
        while known not in self.marks:
            known = known[:-1]
        mark = self.marks[known]
        at_key = at_key or len(known) < len(path)
        return Finding(
            file=self.file,
            line=mark.key_line if at_key else mark.line,
            column=mark.key_column if at_key else mark.column,
            path=dotted(path),
            text=text,
        )


def read_marked(path: Path | str) -> MarkedTree:
    """Read a YAML file into values and marks; no key is checked yet.

    Raises
    ------
    ConfigError : every finding of the text, as ``file:line:column  path: text``.
    """
    shown = str(path)
    try:
        raw = read_plain(Path(path), MAX_BYTES)
    except TooLargeError as error:
        what = f"{error}. This is not a site file."
        raise SiteFileError([_at(shown, 1, 1, what)]) from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else f"it {error}"
        raise SiteFileError(
            [_at(shown, 1, 1, f"cannot be read: {reason}. Check the path.")]
        ) from error
    return parse_marked(raw, shown)


def marked_text(raw: bytes, file: str) -> MarkedTree:
    """Read what a YAML file might say; errors, and its largest size, as in `read_marked`."""
    if len(raw) > MAX_BYTES:
        what = f"is larger than {MAX_BYTES >> 10} kB. This is not a site file."
        raise SiteFileError([_at(file, 1, 1, what)])
    return parse_marked(raw, file)


def parse_marked(raw: bytes, file: str) -> MarkedTree:
    """Read the bytes of a YAML file called ``file``; errors as in `read_marked`."""
    text = _decoded(raw, file)
    tabs = _tabs(text, file)
    if tabs:
        raise SiteFileError(tabs)
    root = _composed(text, file)
    maker = _Maker(file)
    values = maker.value(root, (), root)
    if maker.findings:
        raise SiteFileError(dict.fromkeys(maker.findings))  # merged again and again, told once
    if not isinstance(values, dict):
        wrong = MarkedTree(file=file, values={}, marks=maker.marks)
        raise SiteFileError(
            [wrong.finding((), "the file must be a mapping, such as `version: 1`.")]
        )
    return MarkedTree(file=file, values=values, marks=maker.marks, raw=raw)


def _at(file: str, line: int, column: int, text: str) -> Finding:
    return Finding(file=file, line=line, column=column, path="", text=text)


def _decoded(raw: bytes, file: str) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = raw[: error.start]
        line = before.count(b"\n") + 1
        column = error.start - (before.rfind(b"\n") + 1) + 1
        text = f"byte 0x{raw[error.start]:02x} is not UTF-8. Save the file as UTF-8."
        raise SiteFileError([_at(file, line, column, text)]) from error


def _tabs(text: str, file: str) -> list[Finding]:
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        body = line.lstrip(" \t")
        tab = line[: len(line) - len(body)].find("\t")
        if tab >= 0 and body and not body.startswith("#"):
            what = "a tab indents this line. YAML takes spaces only: replace it by spaces."
            found.append(_at(file, number, tab + 1, what))
    return found


def _composed(text: str, file: str) -> yaml.Node:
    try:
        root = compose(text, BOUNDS)
    except YamlTextError as error:
        raise SiteFileError([_refused(error, file)]) from error
    if root is None:
        raise SiteFileError([_at(file, 1, 1, "the file is empty. Start from config/euclid.yaml.")])
    return root


def _refused(error: YamlTextError, file: str) -> Finding:
    """Return in a technician's words why a text was not taken."""
    line, column = error.place or (1, 1)
    match error.fault:
        case Fault.SYNTAX:
            what = f"{error.problem}. Check brackets, quotes, colons and indentation."
        case Fault.DEPTH | Fault.COUNT:
            what = f"nests deeper than {MAX_DEPTH} levels or holds over {MAX_NODES} values."
        case _:
            what = f"is not YAML: {error.problem.splitlines()[0]}."
    return _at(file, line, column, what)


@dataclass(slots=True)
class _Maker:
    """Turns nodes into values; collects marks and findings on the way."""

    file: str
    marks: dict[KeyPath, Mark] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)
    nodes: int = 0
    merges: int = 0  # sections merged into one another on the way here

    def value(self, node: yaml.Node, path: KeyPath, key: yaml.Node) -> Tree:
        self.nodes += 1
        written = node.value if isinstance(node, yaml.ScalarNode) else ""
        line, column = line_and_column(node)
        key_line, key_column = line_and_column(key)
        self.marks[path] = Mark(
            line=line, column=column, key_line=key_line, key_column=key_column, written=written
        )
        if self._is_too_much(node, path):
            return None
        if isinstance(node, yaml.MappingNode) and node.tag == _TAG + "map":
            return self._mapping(node, path)
        if isinstance(node, yaml.SequenceNode) and node.tag == _TAG + "seq":
            return tuple(self.value(item, (*path, i), item) for i, item in enumerate(node.value))
        if isinstance(node, yaml.ScalarNode):
            return self._scalar(node, path)
        self._find(node, path, f"tag {_short_tag(node.tag)} is not allowed. Remove it.")
        return None

    def _mapping(self, node: yaml.MappingNode, path: KeyPath) -> dict[str, Tree]:
        made: dict[str, Tree] = {}
        seen: dict[str, int] = {}
        merged: list[yaml.Node] = []
        for key, item in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._find(key, path, "a key must be one word, not a list or a section.")
            elif key.tag == _TAG + "merge":
                merged.append(item)
            elif key.value in seen:
                what = f"key stands twice, first in line {seen[key.value]}. Remove one of the two."
                self._find(key, (*path, key.value), what)
            elif made and node.flow_style and self._is_comma_tail(key, item):
                self._decimal_comma(node, list(made)[-1], path, key.value)
            else:
                seen[key.value] = line_and_column(key)[0]
                made[key.value] = self.value(item, (*path, key.value), key)
        for item in merged:
            self._merge(item, path, made)
        return made

    def _is_too_much(self, node: yaml.Node, path: KeyPath) -> bool:
        """Return whether to unfold no further; said once, at the place where it was enough."""
        if self.nodes <= MAX_NODES and len(path) + self.merges <= MAX_DEPTH:
            return False
        if not self.findings:
            self._find(node, path, "aliases unfold to too much. Write it out.")
        return True

    def _merge(self, item: yaml.Node, path: KeyPath, made: dict[str, Tree]) -> None:
        parts = item.value if isinstance(item, yaml.SequenceNode) else [item]
        for part in parts:
            self.nodes += 1  # a section without keys costs its time too
            if self._is_too_much(item, path):
                return
            if not isinstance(part, yaml.MappingNode):
                self._find(item, path, "`<<` takes a section (an alias such as *base).")
                return
            shadow = _Maker(
                self.file, findings=self.findings, nodes=self.nodes, merges=self.merges + 1
            )
            inherited = shadow._mapping(part, path)
            fresh = inherited.keys() - made.keys()
            made.update((name, value) for name, value in inherited.items() if name in fresh)
            for known, mark in shadow.marks.items():
                if known[len(path)] in fresh:
                    self.marks[known] = mark
            self.nodes = shadow.nodes

    @staticmethod
    def _is_comma_tail(key: yaml.ScalarNode, item: yaml.Node) -> bool:
        empty = isinstance(item, yaml.ScalarNode) and item.value == ""
        return empty and _AFTER_COMMA.fullmatch(key.value) is not None

    def _decimal_comma(self, node: yaml.Node, name: str, path: KeyPath, tail: str) -> None:
        mark = self.marks[(*path, name)]
        self.findings.append(
            Finding(
                file=self.file,
                line=mark.line,
                column=mark.column,
                path=dotted((*path, name)),
                text=f'"{mark.written},{tail}" has a decimal comma. Write {mark.written}.{tail}.',
            )
        )

    def _scalar(self, node: yaml.ScalarNode, path: KeyPath) -> Tree:
        kind, written = node.tag.removeprefix(_TAG), node.value
        if kind in ("str", "timestamp", "value", "merge"):
            if _CONTROL.search(written):
                self._find(node, path, "holds a control character, such as \\0. Remove it.")
            return str(written)
        if kind == "null":
            return None
        if kind == "bool" and written.casefold() in _BOOLEANS:
            return _BOOLEANS[written.casefold()]
        if kind in ("int", "float"):
            return self._number(node, path)
        self._find(node, path, f"tag {_short_tag(node.tag)} is not allowed. Remove it.")
        return None

    def _number(self, node: yaml.ScalarNode, path: KeyPath) -> Tree:
        written = node.value
        if _PLAIN_INT.fullmatch(written):
            return int(written, 16) if "x" in written else int(written)
        if _PLAIN_FLOAT.fullmatch(written) and math.isfinite(float(written)):
            return float(written)
        short = written if len(written) <= 40 else f"{written[:37]}..."
        if ":" in written:
            what = f"{short} is a base-60 number in YAML 1.1. Write a plain number, or quotes."
        elif re.fullmatch(r"[-+]?0[0-7_]+", written):
            what = f"{short} is an octal number in YAML 1.1. Write {written.lstrip('+-0_') or 0}."
        elif "_" in written:
            what = f"{short} has underscores. Write {short.replace('_', '')}."
        else:
            what = f"{short} is not a finite number. Write a number such as {plain(1.5)}."
        self._find(node, path, what)
        return None

    def _find(self, node: yaml.Node, path: KeyPath, text: str) -> None:
        line, column = line_and_column(node)
        self.findings.append(
            Finding(file=self.file, line=line, column=column, path=dotted(path), text=text)
        )


def _short_tag(tag: str | None) -> str:
    return (tag or "?").replace(_TAG, "!!")[:40]
