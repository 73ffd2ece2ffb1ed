"""Whether a person may do something now: one pure function, before the press and at the press.

The screen asks it to grey a button and to say why; the service asks it again with what it knows
itself. The guard has the last word: what is allowed here is asked of it, and may still be refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, StrEnum

from aff_runtime.app.report.status import explain
from aff_runtime.base.events import BY_NAME, Reaction
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import LATCHED_STATES, State
from aff_runtime.safety.reasons import REMOTE, SHADOW


class Action(StrEnum):
    """What can be asked for."""

    BYPASS = "bypass"
    ARM = "arm"
    PROBE = "probe"
    PROBE_LOUDER = "probe-louder"
    SHADOW = "shadow"
    END_SHADOW = "end-shadow"
    FORGET = "forget"
    TRY = "try"
    KEEP = "keep"
    SAVE = "save"
    UNDO = "undo"


PROBES = (Action.PROBE, Action.PROBE_LOUDER)
"""What excites the line: it needs the role commission, and no law."""
OF_SETTINGS = (Action.TRY, Action.KEEP, Action.SAVE, Action.UNDO)
"""What a screen asks of the commissioner, which asks the service; the hand hears all others."""
BY_HAND = tuple(action for action in Action if action not in OF_SETTINGS)

# what to type at the console where the service lets no screen do it
ON_CONSOLE = {
    Action.ARM: "arm",
    Action.SHADOW: "shadow on",
    Action.END_SHADOW: "shadow off",
    Action.FORGET: "forget",
}


class Role(IntEnum):
    """What an account is for; a later role may do all that an earlier one may do."""

    VIEW = 0
    OPERATE = 1
    COMMISSION = 2

    @property
    def word(self) -> str:
        """Return the role as people write it."""
        return self.name.lower()


ROLES = {role.word: role for role in Role}


class Place(StrEnum):
    """Where a person is: at the machine itself, or somewhere on its network."""

    PANEL = "panel"
    NETWORK = "network"


class Code(StrEnum):
    """Why not."""

    LOGGED_OUT = "logged out"
    TOKEN = "token"
    SILENT = "silent"
    CEILING = "ceiling"
    NO_PROBE = "no probe"
    NO_SETTINGS = "no settings"
    PLACE = "place"
    ROLE = "role"
    PROBE_ROLE = "probe role"
    SETTINGS_ROLE = "settings role"
    IDLE = "idle"
    NO_HAND = "no hand"
    OTHER_HAND = "other hand"
    ALREADY = "already"
    SHADOWED = "shadowed"
    NO_SHADOW = "no shadow"
    REMOTE = "remote"
    GOES_OUT = "goes out"
    FADING = "fading"
    PROBING = "probing"
    TRYING = "trying"
    NO_TRY = "no try"
    GUARD = "guard"
    LATE = "late"
    REPEATED = "repeated"
    CHANGED = "changed"
    FAST = "fast"
    UNRECORDED = "unrecorded"
    REFUSED = "refused"


WORDS = {
    Code.LOGGED_OUT: "log in first",
    Code.TOKEN: "this page is older than your login: load it again",
    Code.SILENT: "no fresh data from the control process",
    Code.CEILING: "the service lets no screen do this; on the gateway: aff-runtime {name}",
    Code.NO_PROBE: "the service lets no screen probe: run it with --hand commission",
    Code.NO_SETTINGS: "the service lets no screen change settings: run it with --hand commission",
    Code.PLACE: "this is for the panel at the machine, not for the network",
    Code.ROLE: "this account may not do this; the role operate is needed",
    Code.PROBE_ROLE: "this account may not probe; the role commission is needed",
    Code.SETTINGS_ROLE: "this account may not change settings; the role commission is needed",
    Code.IDLE: "nothing was pressed for too long: log in again",
    Code.NO_HAND: "take the hand first",
    Code.OTHER_HAND: "{name} has the hand",
    Code.ALREADY: "it is armed already",
    Code.SHADOWED: "it is in shadow already",
    Code.NO_SHADOW: "it is not in shadow",
    Code.REMOTE: "the line is in remote: this is the PLC's",
    Code.GOES_OUT: "a correction goes out; bypass first",
    Code.FADING: "the correction is on its way to zero; wait",
    Code.PROBING: "a probe is under way",
    Code.TRYING: "settings are being tried; keep or undo them first",
    Code.NO_TRY: "no settings are being tried",
    Code.GUARD: "blocked by {name}",
    Code.LATE: "it came too late, nothing was done: press again",
    Code.REPEATED: "it was heard before, nothing was done",
    Code.CHANGED: "the state has changed since you looked: it is {name} now",
    Code.FAST: "too many commands at once: wait a few seconds",
    Code.UNRECORDED: "the service cannot keep its audit, so no screen arms",
    Code.REFUSED: "refused: {name}",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Reason:
    """One reason why not; ``name`` is what ``{name}`` of its words stands for.

    By code: CEILING a command of the console, OTHER_HAND an account, GUARD the guard's reason,
    CHANGED a state, REFUSED a sentence; empty for all others.
    """

    code: Code
    name: str = ""

    @property
    def text(self) -> str:
        """Return it as the service says it."""
        name = explain(self.name) if self.code is Code.GUARD else printable(self.name, 200)
        return WORDS[self.code].replace("{name}", name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Person:
    """Who asks.

    Attributes
    ----------
    role : of the account; None for somebody who has not logged in.
    has_hand : whether this very session has it.
    is_idle : nothing was pressed for too long.
    """

    role: Role | None
    place: Place
    has_hand: bool = False
    is_idle: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Circumstances:
    """How the service stands.

    Attributes
    ----------
    state : of the guard; None where no fresh tick is known.
    blocked : the guard's first reason against an armed output, empty for none; REMOTE is one.
    also_blocking : its others.
    ceiling : the most that a screen may do here.
    commands_from : the farthest place from which anything but a bypass is heard.
    hand_of : account that has the hand, empty for none.
    probing : a probe is under way.
    trying : other settings run, or are checked, for a try.
    remote : the line is in remote.
    bypass_from : the farthest place from which somebody who has not logged in may bypass; None:
        from nowhere.
    """

    state: State | None
    blocked: str = ""
    also_blocking: tuple[str, ...] = ()
    ceiling: Role = Role.VIEW
    commands_from: Place = Place.PANEL
    hand_of: str = ""
    probing: bool = False
    trying: bool = False
    remote: bool = False
    bypass_from: Place | None = None

    @property
    def against(self) -> tuple[str, ...]:
        """The guard's reasons, the first one first."""
        return (self.blocked, *self.also_blocking) if self.blocked else ()


_OF_LAW = re.compile(r"[a-z][A-Za-z0-9_]*: ")
"""What stands against an actuator's law begins with its name; a probe does without the law."""
_MORE = re.compile(r"and \d+ more")


def may(action: Action, person: Person, now: Circumstances) -> tuple[Reason, ...]:
    """Return every reason why not, the first to be said first; empty when it is allowed.

    A bypass needs a login at most, and none from where ``bypass_from`` lets it: no state, no
    hand and no idle time stands against it. Who would arm an output that is armed hears only that
    it is: nobody has to do anything.
    """
    if action is Action.BYPASS:
        is_open = now.bypass_from is Place.NETWORK or now.bypass_from is person.place
        return () if person.role is not None or is_open else (Reason(code=Code.LOGGED_OUT),)
    if action is Action.ARM and now.state in (State.ARMED, State.ACTIVE):
        return (Reason(code=Code.ALREADY),)
    reasons = [
        Reason(code=code, name=ON_CONSOLE[action] if code is Code.CEILING else "")
        for code in _of_person(action, person, now)
    ]
    if not person.has_hand and now.hand_of:
        reasons.append(Reason(code=Code.OTHER_HAND, name=now.hand_of))
    elif not person.has_hand:
        reasons.append(Reason(code=Code.NO_HAND))
    if action in PROBES and now.probing:
        reasons.append(Reason(code=Code.PROBING))
    if action in OF_SETTINGS:
        return (*reasons, *against_settings(action, now))
    of_service = _of_guard if action in (Action.ARM, *PROBES) else _of_rest
    return (*reasons, *of_service(action, now))


def against_settings(action: Action, now: Circumstances) -> tuple[Reason, ...]:
    """Return what stands against a try, or its end, whoever asks; the service asks it, too.

    In remote the line is the PLC's: nothing else is tried, and nothing is kept or saved. The way
    back stays open, and a try that is not kept ends by itself.
    """
    is_try, begins = action is Action.TRY, action in (Action.TRY, Action.SAVE)
    against = {
        Code.SILENT: is_try and now.state is None,
        Code.REMOTE: now.remote and not (action is Action.UNDO and now.trying),
        Code.PROBING: begins and now.probing,
        Code.TRYING: begins and now.trying,
        Code.NO_TRY: action is Action.KEEP and not now.trying,
    }
    return tuple(Reason(code=code) for code, stands in against.items() if stands)


def _of_person(action: Action, person: Person, now: Circumstances) -> list[Code]:
    least, code_of_ceiling, code_of_role = Role.OPERATE, Code.CEILING, Code.ROLE
    if action in PROBES:
        least, code_of_ceiling, code_of_role = Role.COMMISSION, Code.NO_PROBE, Code.PROBE_ROLE
    elif action in OF_SETTINGS:
        least = Role.COMMISSION
        code_of_ceiling, code_of_role = Code.NO_SETTINGS, Code.SETTINGS_ROLE
    against = {
        Code.LOGGED_OUT: person.role is None,
        code_of_ceiling: now.ceiling < least,
        Code.PLACE: person.place is Place.NETWORK and now.commands_from is not Place.NETWORK,
        code_of_role: person.role is not None and person.role < least,
        Code.IDLE: person.is_idle,
    }
    return [code for code, stands in against.items() if stands]


def _of_guard(action: Action, now: Circumstances) -> tuple[Reason, ...]:
    """Return what the guard would say, from its own words."""
    if now.state is None:
        return (Reason(code=Code.SILENT),)
    reasons = tuple(
        Reason(code=Code.GUARD, name=one)
        for one in (_without_law(now) if action in PROBES else now.against)
        if not _is_confirmed_by_arming(one, now.state)
    )
    return reasons or ((Reason(code=Code.FADING),) if now.state is State.FADING else ())


def _without_law(now: Circumstances) -> Sequence[str]:
    """Return the guard's reasons without those of a law.

    ``Blocked.by`` of `app.link.messages` cuts a list that does not fit, tells shadow and remote
    in any case, and ends it with "and N more". Where the last reason before these is a law's, so
    are all N: the guard asks the laws last of all but shadow and remote. The count goes then, too.
    """
    named = [one for one in now.against if one not in (SHADOW, REMOTE)]
    own = [one for one in now.against if not _OF_LAW.match(one)]
    is_of_law = named[1:] and _MORE.fullmatch(named[-1]) and _OF_LAW.match(named[-2])
    return own[:-1] if is_of_law else own


def _of_rest(action: Action, now: Circumstances) -> tuple[Reason, ...]:
    """Return what stands against shadow and forgetting: both are the PLC's in remote."""
    if now.state is None:
        return (Reason(code=Code.SILENT),)
    is_shadow = now.state is State.SHADOW
    against = {
        Code.REMOTE: now.remote,
        Code.PROBING: now.probing,
        Code.SHADOWED: action is Action.SHADOW and is_shadow,
        Code.NO_SHADOW: action is Action.END_SHADOW and not (is_shadow or SHADOW in now.against),
        Code.GOES_OUT: action is Action.FORGET and now.state in (State.ACTIVE, State.FADING),
    }
    reasons = [Reason(code=code) for code, stands in against.items() if stands]
    if action is Action.SHADOW and now.state in LATCHED_STATES:
        latching = filter(_is_latching, now.against)
        reasons += [Reason(code=Code.GUARD, name=one) for one in latching]
    return tuple(reasons)


def _is_latching(blocked: str) -> bool:
    """Whether a reason is a cause that keeps the guard where it has latched."""
    event = BY_NAME.get(blocked.split(" ", maxsplit=1)[0])
    return event is not None and event.reaction is Reaction.FADE_AND_LATCH


def _is_confirmed_by_arming(reason: str, state: State) -> bool:
    """Whether to arm is itself what ends the reason: another roll is confirmed by it."""
    return state in LATCHED_STATES and reason.split(" ", maxsplit=1)[0] == "RADIUS_JUMP"
