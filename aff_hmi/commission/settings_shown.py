"""Settings in the reader's language: the form, what would change, versions.

Names of keys, units and bounds stand as in the site file; what the check says, in English.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from aff_hmi.commission.sentences import sentence
from aff_hmi.words import N_, Say
from aff_runtime.app.commission.views.of_settings import (
    DifferenceView,
    SettingsSection,
    SettingsView,
    SettingView,
    VersionView,
)
from aff_runtime.app.link.settings_answer import Version

VERBS = {
    "started": N_("started with it"),
    "edited": N_("edited in the file"),
    "tried": N_("tried"),
    "returned": N_("returned after a try"),
    "kept": N_("kept"),
    "undone": N_("went back to it"),
}
KINDS = {
    "number": N_("a number"),
    "list": N_("a list of numbers, such as [1, 2]"),
    "flag": N_("true or false"),
    "choice": N_("one of these words"),
    "text": N_("a text"),
}
AT_ONCE = N_("applies at once, between two ticks, while the correction goes out")
WAITS = N_("takes effect at the next bypass: it is saved, and no try can take it back")
ELSEWHERE = N_("does not stand in the site file as one value: edit it in the text")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownSetting(SettingView):
    """A setting with what changing it does.

    Attributes
    ----------
    is_english : its help is in no other language. ``kind_word`` : what is to be written.
    """

    is_english: bool
    kind_word: str
    does: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShownVersion(Version):
    """A version with the word of what became of it."""

    verb_word: str


def settings_in(view: SettingsView, say: Say) -> SettingsView:
    """Return the form; every setting says what changing it does, and whether it can be."""
    return replace(
        view,
        against=sentence(view.against, say),
        sections=sections_in(view.sections, say),
        versions=tuple(_version(one, say) for one in view.versions),
    )


def sections_in(sections: tuple[SettingsSection, ...], say: Say) -> tuple[SettingsSection, ...]:
    """Return a form's sections; every setting says what changing it does."""
    return tuple(
        replace(one, settings=tuple(_setting(inner, say) for inner in one.settings))
        for one in sections
    )


def difference_in(view: DifferenceView, say: Say) -> DifferenceView:
    """Return what would change, and when each applies."""
    return replace(view, changes=tuple(sentence(one, say) for one in view.changes))


def version_in(view: VersionView, say: Say) -> VersionView:
    """Return one version."""
    return replace(
        view,
        version=_version(view.version, say),
        back=difference_in(view.back, say) if view.back is not None else None,
        against=sentence(view.against, say),
    )


def _setting(one: SettingView, say: Say) -> ShownSetting:
    help_said = say(one.help)
    does = ELSEWHERE if not one.can_edit else AT_ONCE if one.live else WAITS
    return ShownSetting(
        path=one.path,
        name=one.name,
        kind=one.kind,
        unit=one.unit,
        allowed=one.allowed,
        choices=one.choices,
        default=one.default,
        shown=one.shown,
        written=one.written,
        live=one.live,
        can_edit=one.can_edit,
        help=help_said,
        is_english=help_said == one.help,
        kind_word=say(KINDS[one.kind]),
        does=say(does),
    )


def _version(one: Version, say: Say) -> ShownVersion:
    return ShownVersion(
        number=one.number,
        when=one.when,
        who=one.who,
        verb=one.verb,
        why=sentence(one.why, say),
        sha256=one.sha256,
        run=one.run,
        verb_word=say(VERBS[one.verb]) if one.verb in VERBS else one.verb,
    )
