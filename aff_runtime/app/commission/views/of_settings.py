"""What a screen is shown of settings, as frozen records: the form, a difference, a version."""

from __future__ import annotations

from dataclasses import dataclass

from aff_runtime.app.link.settings_answer import Version


@dataclass(frozen=True, slots=True, kw_only=True)
class Clash:
    """Lines that two people have changed; ``line`` : of the text put together, from 1."""

    line: int
    theirs: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SaidOfSetting:
    """What the check says.

    Attributes
    ----------
    path : of the setting, empty where it is of none.
    line, column : where it stands in the text, from 1; 0 where that is not said.
    """

    path: str
    text: str
    line: int = 0
    column: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingView:
    """One setting.

    Attributes
    ----------
    path : of keys in the site file. ``name`` : the last of them.
    kind : ``number``, ``list``, ``flag``, ``choice`` or ``text``.
    unit : of a bare number. ``allowed`` : its bounds in words. ``choices`` : what may be written.
    default : in words. ``shown`` : present value with its unit. ``written`` : as it stands in the
        file; empty where it is left to its default.
    live : may change while a correction goes out, so that it can be tried; another one takes
        effect at the next bypass. ``can_edit`` : it stands in the file as one value, or can be
        written into it.
    help : what it does and when to change it.
    """

    path: str
    name: str
    kind: str
    unit: str
    allowed: str
    choices: tuple[str, ...]
    default: str
    shown: str
    written: str
    live: bool
    can_edit: bool
    help: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsSection:
    """Settings below one path of keys.

    Attributes
    ----------
    roll : that they are about, where the path has a number in a list for it, such as of
        ``actuators.unwind.blocks[0]`` the roll of that block; else empty.
    """

    path: str
    roll: str
    settings: tuple[SettingView, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsView:
    """The site file as a form.

    Attributes
    ----------
    sha256 : of the text of which this is, empty where it is not good. ``running`` : of what runs.
    against : why nothing can be tried, or empty.
    said : what the check says of the file.
    versions : the history, newest first.
    """

    site: str
    sha256: str
    running: str
    against: str
    said: tuple[SaidOfSetting, ...]
    sections: tuple[SettingsSection, ...]
    versions: tuple[Version, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferenceView:
    """What saving a text would change against the settings in force.

    Attributes
    ----------
    sha256 : of the text. ``changes`` : with units, and when each applies.
    said : new warnings; of a text that is refused, why. ``refused`` : it cannot run.
    waits : it cannot be tried, as something in it waits for bypass; it can be saved.
    lines : changed lines with their context.
    """

    sha256: str
    changes: tuple[str, ...]
    said: tuple[SaidOfSetting, ...]
    refused: bool
    waits: bool
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TextView:
    """A text that is edited, with the same settings as a form.

    Attributes
    ----------
    base : sha256 of the site file that it is an edit of. ``file`` : that file's text.
    text : with every edit in it; both as a field of a browser has them.
    said : what the check says of it. ``sections`` : as of the form; none where it is refused.
    clashes : lines that somebody else has changed too, where two edits were put together.
    """

    base: str
    file: str
    text: str
    said: tuple[SaidOfSetting, ...]
    sections: tuple[SettingsSection, ...]
    clashes: tuple[Clash, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionView:
    """One version.

    Attributes
    ----------
    lines : of its text, against the text that ran before it.
    back : what going back to it would change now; None where it cannot be said.
    running : sha256 of the text that runs now, when this is shown.
    against : why one cannot go back to it, or empty.
    """

    version: Version
    lines: tuple[str, ...]
    back: DifferenceView | None
    running: str
    against: str
