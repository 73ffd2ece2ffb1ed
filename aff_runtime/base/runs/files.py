"""Files of a run folder, which somebody else may have made: regular, bounded, plain values."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path
from typing import Any, BinaryIO

import yaml

from aff_runtime.base.yaml_places import Bounds, SafeLoader, YamlTextError, compose

MOST_VALUES = 50_000
"""Keys and values of a YAML file, those that aliases repeat counted each time."""
DEEPEST = 32
"""Sections within sections."""
LONGEST_VALUE = 3_500
"""Characters of one value: Python still turns a whole number of so many digits into text."""
_BOUNDS = Bounds(depth=DEEPEST, events=2 * MOST_VALUES, characters=LONGEST_VALUE)


def open_plain(path: Path) -> BinaryIO:
    """Open a regular file to read; a link is none, it could lead to a file of the reader's own.

    A pipe could wait and a device go on for ever: what is no regular file is not even opened. The
    open file is looked at once more: another one may have taken its place in between.

    Raises
    ------
    OSError
        It is not there, may not be read, or is no regular file.
    """
    _refuse_other_kinds(path, os.lstat(path).st_mode)
    flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY | os.O_NOFOLLOW
    descriptor = os.open(path, flags)
    stream = open(descriptor, "rb")  # noqa: SIM115 - the caller closes it
    try:
        _refuse_other_kinds(path, os.fstat(descriptor).st_mode)
    except OSError:
        stream.close()
        raise
    return stream


def _refuse_other_kinds(path: Path, mode: int) -> None:
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "is no file", str(path))


def text_of(path: Path, longest: int) -> str:
    """Return the first ``longest`` bytes of a file as text, empty where none can be read."""
    try:
        with open_plain(path) as file:
            there = os.fstat(file.fileno()).st_size  # read(n) takes n bytes of memory first
            return file.read(min(longest, there)).decode("utf-8", "replace")
    except OSError:
        return ""


def yaml_values(text: str) -> Any:
    """Return the plain values of a YAML text.

    Raises
    ------
    ValueError
        It is not YAML, holds an impossible value (a 13th month), or more than a person writes:
        aliases and merged sections can double line by line.
    """
    try:
        root = compose(text, _BOUNDS)
        if root is None:
            return None
        _unfolded(root, 0, 0)
        return SafeLoader("").construct_document(root)
    except YamlTextError as error:
        raise ValueError(error.problem or "nested too deep, or too many values") from error
    except (yaml.YAMLError, ArithmeticError, AttributeError, LookupError) as error:
        # what PyYAML's constructors of numbers, booleans and times raise on a tagged value
        raise ValueError(str(error)) from error


def _unfolded(node: yaml.Node, depth: int, count: int) -> int:
    """Return ``count`` and how many values a node has with all its aliases unfolded."""
    count += 1
    if count > MOST_VALUES or depth > DEEPEST:
        raise ValueError("its aliases unfold to too much")
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            count = _unfolded(value, depth + 1, _unfolded(key, depth + 1, count))
    elif isinstance(node, yaml.SequenceNode):
        for item in node.value:
            count = _unfolded(item, depth + 1, count)
    return count
