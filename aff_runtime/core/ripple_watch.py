"""Whether ripple grew since the output opened: the sign that a response is wrong."""

from __future__ import annotations

from math import inf, isfinite, nan, sqrt

ROSE = 1.3  # ripple over the reference, above which it rose
NOISE_SIGMAS = 4.0  # standard deviations above the reference, above which it rose
ROSE_TURNS = 4.0  # for so long it has to stand above both
FADE_TURNS = 5.0  # after a closing or a change of speed the ripple is on its way for so long
LAG_TURNS = 3.0  # memory of the ripple that the present one is a decline of
NOISE_TURNS = 10.0  # memory of mean and scatter without correction
FALLING = 0.9  # ripple over that, below which it declines
SAME_SPEED = 0.2  # of the speed: a larger change asks for another reference


class RippleWatch:
    """Compares one actuator's ripple with what it was before its output opened.

    The reference is the ripple without correction; its own scatter is the noise. It is taken anew
    after every closing, and after the speed has moved by a fifth, since ripple changes with speed:
    then it is what the law expects without correction, never above what was there without, never
    below the ripple now; a quiet moment alone would make the next louder one a rise. A closing so
    short that the ripple could not come back, as for an edit of the blocks, changes nothing.
    ``step`` returns True once ripple has stood above 1.3 times the reference and four standard
    deviations above it for four turns that were not a decline, as after a step of the setpoint.
    Never raises; an unknown ripple (NaN) is never judged.

    Attributes
    ----------
    reference : ripple to compare with, in the signal's unit; NaN until known.
    """

    def __init__(self) -> None:
        self.reference = nan
        self._without = nan  # ripple without correction, as of the last opening
        self._mean = nan
        self._variance = self._age_turns = 0.0
        self._was_open = False
        self._speed_m_s = nan
        self._lagged = nan
        self._risen_turns = 0.0
        self._settle_turns = 0.0

    def step(
        self, ripple: tuple[float, float], *, is_open: bool, speed_m_s: float, turns: float
    ) -> bool:
        """Take a reading and return whether ripple rose.

        Parameters
        ----------
        ripple : before and now, as ``ActuatorLaw.ripple`` returns them.
        is_open : a correction goes out.
        speed_m_s : line speed; NaN when unknown.
        turns : turns of the slowest roll since the last reading.
        """
        before, now = ripple
        if not is_open:
            self._watch_closed(now, turns)
            self._was_open = False
            self._speed_m_s = speed_m_s
            return False
        if not self._was_open:
            self._open(before)
        if not isfinite(now):
            return False
        self._follow_speed(speed_m_s)
        if self._settle_turns > 0.0:
            self._settle_turns -= turns
            self._lagged = now
            is_known = isfinite(before) and isfinite(self._without)
            self.reference = max(now, min(before, self._without)) if is_known else now
            return False
        if not isfinite(self.reference):
            self.reference = before if isfinite(before) else now
        return self._judge(now, turns)

    def _judge(self, now: float, turns: float) -> bool:
        if not isfinite(self._lagged):
            self._lagged = now
        self._lagged += min(1.0, turns / LAG_TURNS) * (now - self._lagged)
        noise = sqrt(self._variance)
        if not (now > ROSE * self.reference and now > self.reference + NOISE_SIGMAS * noise):
            self._risen_turns = 0.0
        elif now >= FALLING * self._lagged:
            self._risen_turns += turns
        return self._risen_turns >= ROSE_TURNS

    def _watch_closed(self, now: float, turns: float) -> None:
        """Learn mean and scatter of the ripple without correction, once the fade has passed."""
        if self._was_open:
            self._settle_turns = FADE_TURNS
        if self._settle_turns > 0.0:
            self._settle_turns -= turns
            if self._settle_turns > 0.0:
                return
            self.reference = self._mean = nan
            self._variance = self._age_turns = 0.0
        if not isfinite(now):
            return
        self._age_turns = min(self._age_turns + turns, NOISE_TURNS)
        share = min(1.0, turns / self._age_turns) if self._age_turns > 0.0 else 1.0
        change = now - (self._mean if isfinite(self._mean) else now)
        self._mean = now - change + share * change
        self._variance = (1.0 - share) * (self._variance + share * change * change)

    def _open(self, before: float) -> None:
        closed = self._without if self._settle_turns > 0.0 else self._mean
        known = [value for value in (before, closed) if isfinite(value)]
        self.reference = self._without = max(known, default=nan)
        self._was_open = True
        self._lagged = nan
        self._risen_turns = self._settle_turns = 0.0

    def _follow_speed(self, speed_m_s: float) -> None:
        if not isfinite(speed_m_s):
            return
        room = SAME_SPEED * abs(self._speed_m_s) if isfinite(self._speed_m_s) else inf
        if abs(speed_m_s - self._speed_m_s) > room:
            self._settle_turns = FADE_TURNS
            self._risen_turns = 0.0
        if room == inf or self._settle_turns == FADE_TURNS:
            self._speed_m_s = speed_m_s
