"""From the site file to a `Site`, or to everything that is wrong with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from aff_runtime.config import can_wire, site_paths, tls_files
from aff_runtime.config.findings import Finding, SiteFileError, in_file_order
from aff_runtime.config.messages import empty_keys, findings_of
from aff_runtime.config.models import Site
from aff_runtime.config.rules import (
    actuators,
    channels,
    registers,
    rolls,
    shape,
    status,
    timing,
    wire,
)
from aff_runtime.config.rules.issue import Issue
from aff_runtime.config.scales import convert_scales
from aff_runtime.config.site_paths import STATE_DIRECTORY
from aff_runtime.config.yaml_marks import MarkedTree, marked_text, parse_marked, read_marked

_RULES: tuple[Callable[[Site], Iterator[Issue]], ...] = (
    wire.issues,
    channels.issues,
    registers.issues,
    status.issues,
    actuators.issues,
    shape.issues,
    rolls.issues,
    timing.issues,
)


# What stands in files that are no site files: keys to tell them by, what to do instead.
_OTHERS = (
    (
        ("schema", "rollers"),
        "this is a line declaration, which sim-plant reads. "
        "Give a site file, such as config/euclid.yaml.",
    ),
    (
        ("device", "registers"),
        "this is a device profile, to copy register numbers from. `aff-runtime map --device FILE` "
        "shows it; here give a site file, such as config/euclid.yaml.",
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A valid site file, what deserves a look in it, and where every key stands."""

    site: Site
    warnings: tuple[Finding, ...]
    tree: MarkedTree


def load_site(path: Path | str, state: Path = STATE_DIRECTORY) -> Site:
    """Read and check a site file and the files it names; SI numbers inside, no other I/O.

    Parameters
    ----------
    state : folder beside the site file's own that what it names may lie in.

    Raises
    ------
    ConfigError : all findings, one per line: ``file:line:column  path: what, what to do``.
    """
    return read_site(path, state).site


def read_site(
    path: Path | str, state: Path = STATE_DIRECTORY, text: bytes | None = None
) -> Reading:
    """Read and check a site file; like `load_site`, with warnings and marks.

    ``text`` : what the file might say instead; None: what it says.
    """
    tree = read_marked(path) if text is None else marked_text(text, str(path))
    for keys, what in _OTHERS:
        if all(key in tree.values for key in keys):
            raise SiteFileError([tree.finding((keys[0],), what, at_key=True)])
    findings = empty_keys(tree)
    if findings:
        raise SiteFileError(findings)
    findings = convert_scales(tree)
    try:
        site = Site.model_validate(tree.values)
    except ValidationError as error:
        raise SiteFileError([*findings, *findings_of(error, tree, Site)]) from error
    warnings: list[Finding] = []
    for issue in _issues(site, Path(path).absolute().parent, state):
        finding = tree.finding(issue.path, issue.text, at_key=issue.at_key)
        (warnings if issue.warning else findings).append(finding)
    if findings:
        raise SiteFileError(findings)
    return Reading(site=site, warnings=in_file_order(warnings), tree=tree)


def load_recorded_site(text: str, file: str) -> Site:
    """Return the site file in the text that a run has of it; what it names is not looked for.

    Raises
    ------
    ConfigError : it cannot be read by this version.
    """
    tree = parse_marked(text.encode(), file)
    if findings := [*empty_keys(tree), *convert_scales(tree)]:
        raise SiteFileError(findings)
    try:
        return Site.model_validate(tree.values)
    except ValidationError as error:
        raise SiteFileError(findings_of(error, tree, Site)) from error


def _issues(site: Site, folder: Path, state: Path) -> Iterator[Issue]:
    complete = True
    for found in (*(rule(site) for rule in _RULES), site_paths.issues(site, folder, state)):
        for issue in found:
            complete = complete and issue.warning
            yield issue
    if complete:  # nothing is read that lies where it must not
        yield from can_wire.issues(site, folder)
        yield from tls_files.issues(site, folder)
