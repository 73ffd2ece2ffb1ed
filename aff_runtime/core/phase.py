"""The angle of one roll: encoder first, roll speed next, line speed over radius last."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import IntEnum

from aff_runtime.core.count_wraps import CountWraps
from aff_runtime.core.encoder import STUCK_SHARE, EncoderCheck, Trust
from aff_runtime.core.long_gap import JITTER_S, JUMP_RAD, has_whole_turns, turned_in_gap
from aff_runtime.core.params import RollParams

OMEGA_TAU_S = 0.05  # time constant of the speed
PREDICT_MAX_S = 0.5  # without a reading for longer the angle is lost
AGREEING_SAMPLES = 4  # encoder readings in a row that make a new reference
RATIO_RANGE = (0.7, 1.4)  # turn of the encoder over turn by the speed channel that is no objection


class Source(IntEnum):
    """Where the angle comes from."""

    NONE = 0
    ENCODER = 1
    ROLL_SPEED = 2
    LINE_SPEED = 3


class Quality(IntEnum):
    """How far the angle can be trusted; only GOOD and PREDICTED may drive adaptation."""

    LOST = 0
    PREDICTED = 1
    GOOD = 2


_ENCODER = Source.ENCODER
_LOST, _PREDICTED, _GOOD = Quality.LOST, Quality.PREDICTED, Quality.GOOD
_OUT, _STOOD = Trust.OUT, Trust.STOOD


class RollPhase:
    """Continuous angle and speed of one roll.

    ``theta_rad`` is the angle now; while the line moves it never jumps by more than a plausible
    motion, whatever the sources do: encoder wraps are unfolded, single glitches are predicted
    over, and after a reset or a change of source an offset keeps it continuous. ``lead(lead_s)``
    gives the angle at which a command acts. Call ``step`` once per tick.

    Attributes
    ----------
    origin_lost : in this tick the angle is known again after it was lost, but nobody knows how it
        stands to the one before: what was learned on it is worth nothing.
    origin_losses : how often that was.
    wraps : whether the encoder's count starts over early.
    """

    __slots__ = (
        "_agreeing",
        "_angle",
        "_candidate",
        "_candidate_gap_s",
        "_candidate_span_rad",
        "_candidate_span_s",
        "_check",
        "_gap_s",
        "_last_model",
        "_line_speed",
        "_modulus",
        "_own_raw",
        "_own_theta",
        "_p",
        "_radius",
        "_radius_read",
        "_raw",
        "_raw_gap_s",
        "_refused",
        "_seeded",
        "_speed",
        "_theta_at_raw",
        "_tracked",
        "omega_rad_s",
        "origin_losses",
        "origin_lost",
        "quality",
        "radius_m",
        "source",
        "theta_rad",
        "wraps",
    )

    def __init__(self, params: RollParams, channels: Mapping[str, int]) -> None:
        self._p = params
        self._angle = _index(params.angle, channels)
        self._speed = _index(params.speed, channels)
        self._line_speed = _index(params.line_speed, channels)
        self._radius = _index(params.radius, channels)
        self._modulus = params.angle_modulus_rad or 0.0
        self.radius_m = params.radius_m if params.radius_m is not None else math.nan
        self._radius_read = math.nan
        self.theta_rad = 0.0
        self.origin_losses = 0
        self.wraps = CountWraps(params)
        self.restart()

    def restart(self) -> None:
        """Forget speed and encoder reference (a new roll); the angle goes on from where it is."""
        self.omega_rad_s = 0.0
        self.source = Source.NONE
        self.quality = _LOST
        self.origin_lost = False
        self._raw = math.nan
        self._raw_gap_s = 0.0
        self._theta_at_raw = self.theta_rad
        self._tracked = self.theta_rad
        self._gap_s = 0.0
        self._seeded = False
        self._candidate = math.nan
        self._candidate_gap_s = self._candidate_span_rad = self._candidate_span_s = 0.0
        self._agreeing = self._refused = 0
        self._check = EncoderCheck()
        self._own_raw, self._own_theta = math.nan, self.theta_rad
        self._last_model = math.nan

    def objection(self) -> str:
        """Return what speaks against the encoder's settings, empty when nothing does.

        An encoder that stands still is no objection: the speed channel takes its place.
        """
        low, high = RATIO_RANGE
        ratio = self._check.ratio
        if not abs(ratio) >= STUCK_SHARE or low <= ratio <= high:
            return ""
        name, angle = self._p.name, self._p.angle
        if ratio < 0.0:
            return (
                f"{name}: {angle} counts against the line's speed; turn the sign of its scale, "
                "or that of the speed"
            )
        return (
            f"{name}: {angle} turns {ratio:.2f} times as fast as speed over radius; mend its "
            "scale (counts per turn of the roll, gear), the radius or the channel"
        )

    def radius_note(self) -> str:
        """Return that the last reading of the radius was not taken, and what counts instead.

        Empty where it was, where none came yet, and for a fixed radius.
        """
        read, low, high = self._radius_read, self._p.radius_min_m, self._p.radius_max_m
        if not math.isfinite(read) or low <= read <= high:
            return ""
        where = f"below radius_min_m {low:g} m" if read < low else f"above radius_max_m {high:g} m"
        known = math.isfinite(self.radius_m)
        stays = (
            f"the last one within, {self.radius_m:.4g} m, stays" if known else "no radius is known"
        )
        return (
            f"{self._p.name}: {self._p.radius} is {where}: not taken, {stays}; mend its scale, or "
            "the range"
        )

    def follow(self, old: RollPhase) -> None:
        """Go on where ``old`` stands; with other settings, from its angle and speed."""
        if replace(old._p, moves_above_m_s=self._p.moves_above_m_s) == self._p:
            for name in self.__slots__:
                if name not in {"_p", "_angle", "_speed", "_line_speed", "_radius"}:
                    setattr(self, name, getattr(old, name))
            return
        self.theta_rad, self.origin_losses = old.theta_rad, old.origin_losses
        self.restart()
        self.omega_rad_s = old.omega_rad_s
        self.quality = min(old.quality, _PREDICTED)
        self._seeded, self._gap_s = old._seeded, old._gap_s  # a gap goes on: no origin comes back

    @property
    def origin_rad(self) -> float:
        """``theta_rad`` where the encoder reads zero; NaN without a whole number of turns.

        A counter that starts over after anything else than whole turns has no origin, nor has
        a roll whose encoder is not the present source.
        """
        if self.source is not _ENCODER or not has_whole_turns(self._modulus):
            return math.nan
        return math.remainder(self._theta_at_raw - self._raw, math.tau)

    def lead(self, lead_s: float) -> float:
        """Return the angle ``lead_s`` from now, rad."""
        return self.theta_rad + self.omega_rad_s * lead_s

    def step(self, values: Sequence[float], dt_s: float, fresh: bool) -> None:
        """Advance by ``dt_s``; ``values`` count only when ``fresh``."""
        self.origin_lost = False
        if not 0.0 < dt_s < math.inf:
            return
        self._gap_s += dt_s
        self._raw_gap_s += dt_s
        self._candidate_gap_s += dt_s
        if not fresh:
            self._predict(dt_s)
            return
        self._read_radius(values)
        model, model_source = self._model_omega(values)
        angle = values[self._angle] if self._angle >= 0 else math.nan
        if math.isfinite(angle) and self._take_angle(angle, model, dt_s):
            self._last_model = model
            self._refused = 0
            return
        self._refused += 1
        if math.isfinite(model) and (self._angle < 0 or not self._seeded or self._lost(angle)):
            self._integrate(model, model_source, dt_s)
        else:
            self._predict(dt_s)
        self._last_model = model

    def _lost(self, angle: float) -> bool:
        """Whether the encoder is out of service, rather than glitching for a few samples."""
        if not self._check.in_service or not math.isfinite(angle) or self._agreeing > 1:
            return True
        return self._raw_gap_s > PREDICT_MAX_S and self._refused >= AGREEING_SAMPLES

    def _predict(self, dt_s: float) -> None:
        step_rad = self.omega_rad_s * dt_s
        self.theta_rad += step_rad
        late = self._gap_s > PREDICT_MAX_S or not self._seeded
        self.quality = _LOST if late else _PREDICTED

    def _integrate(self, omega: float, source: Source, dt_s: float) -> None:
        before = self._last_model if math.isfinite(self._last_model) else omega
        self.theta_rad += 0.5 * (before + omega) * dt_s
        if self._check.in_service:
            self._raw = math.nan  # an encoder that returns continues from here, without a jump
        keep = math.exp(-self._gap_s / OMEGA_TAU_S) if self._seeded else 0.0
        self.omega_rad_s = omega + (self.omega_rad_s - omega) * keep
        self._tracked = self.theta_rad
        self._accepted(source)

    def _accepted(self, source: Source, *, origin_is_known: bool = False) -> None:
        self.origin_lost = self._seeded and self.quality is _LOST and not origin_is_known
        self.origin_losses += self.origin_lost
        self._seeded = True
        self._gap_s = 0.0
        self.source = source
        self.quality = _GOOD

    def _read_radius(self, values: Sequence[float]) -> None:
        if self._radius >= 0:
            self._radius_read = radius = values[self._radius]
            if self._p.radius_min_m <= radius <= self._p.radius_max_m:
                self.radius_m = radius

    def _model_omega(self, values: Sequence[float]) -> tuple[float, Source]:
        """Return the roll's speed from the best speed channel, rad/s, NaN when there is none."""
        if self._speed >= 0:
            omega = values[self._speed]
            if self._p.speed_is_surface:
                omega /= self.radius_m if self.radius_m > 0.0 else math.nan
            if abs(omega) <= self._p.max_omega_rad_s:
                return omega, Source.ROLL_SPEED
        if self._line_speed >= 0 and self.radius_m > 0.0:
            omega = values[self._line_speed] / self.radius_m
            if abs(omega) <= self._p.max_omega_rad_s:
                return omega, Source.LINE_SPEED
        return math.nan, Source.NONE

    def _turned(self, now: float, before: float, expected: float = 0.0) -> float:
        """Return the motion between two encoder readings, unfolded about ``expected``."""
        turned = now - before
        if not (self._modulus > 0.0 and math.isfinite(turned)):
            return turned
        return turned - self._modulus * round((turned - expected) / self._modulus)

    def _take_angle(self, angle: float, model: float, dt_s: float) -> bool:
        """Follow the encoder; False when this sample (or the encoder) is not to be believed."""
        if not math.isfinite(self._raw):
            return self._try_rebase(angle, dt_s)
        gap_s = self._raw_gap_s
        turned = self._turned(angle, self._raw, self.omega_rad_s * gap_s)
        is_long = gap_s > PREDICT_MAX_S
        if self._check.in_service:
            if is_long:
                turned = self._turned_in_gap(turned, model)
            if not (math.isfinite(turned) if is_long else self._fits(turned)):
                return self._try_rebase(angle, dt_s)
            if is_long:
                self._go_on(angle, turned, model)
                return True
            self._own_raw, self._own_theta = self._raw, self._theta_at_raw
        trust = self._judge(turned, model, gap_s)
        if trust is _OUT:
            # the reference goes along, so that a recovered encoder continues without a jump
            self._hold_reference(angle, self.theta_rad + (model * dt_s))
            return False
        if trust is _STOOD:
            self._go_back(angle)
            return True
        self._hold_reference(angle, self._theta_at_raw + turned)
        self.theta_rad = self._theta_at_raw
        self._track(gap_s)
        self._agreeing = 0
        self._accepted(_ENCODER)
        return True

    def _fits(self, turned: float) -> bool:
        """Return whether the encoder can have turned so far since its last reading."""
        gap_s = self._raw_gap_s
        expected = self.omega_rad_s * gap_s
        acceleration = self._p.max_acceleration_rad_s2
        tolerance = JUMP_RAD + JITTER_S * abs(self.omega_rad_s) + 0.5 * acceleration * gap_s**2
        tolerance = min(tolerance, self._p.max_omega_rad_s * gap_s + JUMP_RAD)
        return not abs(turned - expected) > tolerance

    @property
    def _stands_below_rad_s(self) -> float:
        """Speed below which the roll stands, whatever is read; NaN without a radius."""
        return self._p.moves_above_m_s / self.radius_m if self.radius_m > 0.0 else math.nan

    def _turned_in_gap(self, turned: float, model: float) -> float:
        """Return how far the roll turned since the reading before a long gap, NaN not known."""
        before = self.omega_rad_s
        return turned_in_gap(
            turned,
            self._modulus,
            self._raw_gap_s,
            speeds_rad_s=(before, model if math.isfinite(model) else before),
            stands_below_rad_s=self._stands_below_rad_s,
        )

    def _go_on(self, angle: float, turned: float, model: float) -> None:
        """Follow the encoder across a long gap, from its last reading."""
        self.omega_rad_s = model if math.isfinite(model) else turned / self._raw_gap_s
        self._hold_reference(angle, self._theta_at_raw + turned)
        self.theta_rad = self._tracked = self._theta_at_raw
        self._agreeing = 0
        self._accepted(_ENCODER, origin_is_known=True)

    def _judge(self, turned: float, model: float, gap_s: float) -> Trust:
        if gap_s > PREDICT_MAX_S and math.isfinite(model):
            return _OUT  # as before: nobody knows what the speed did meanwhile
        return self._check.judge(turned, model, gap_s, self._stands_below_rad_s)

    def _hold_reference(self, angle: float, theta_rad: float) -> None:
        """Keep an encoder reading, and the angle of the roll that goes with it."""
        self._raw = angle
        self._raw_gap_s = 0.0
        self._theta_at_raw = theta_rad

    def _track(self, gap_s: float) -> None:
        """Critically damped alpha-beta filter of the speed."""
        keep = math.exp(-gap_s / OMEGA_TAU_S)
        self._tracked += self.omega_rad_s * gap_s
        miss = self.theta_rad - self._tracked
        self._tracked += (1.0 - keep * keep) * miss
        self.omega_rad_s += (1.0 - keep) ** 2 * miss / gap_s

    def _go_back(self, angle: float) -> None:
        """Follow the encoder from where it was when it went out of service; whole turns apart.

        The line has stood for so long that nothing goes out: the angle may jump.
        """
        own = self._own_theta + self._turned(angle, self._own_raw)
        self.theta_rad += math.remainder(own - self.theta_rad, math.tau)
        self._tracked = self.theta_rad
        self._hold_reference(angle, self.theta_rad)
        self._agreeing = 0
        self._accepted(_ENCODER)

    def _try_rebase(self, angle: float, dt_s: float) -> bool:
        """Accept a new encoder origin after samples that agree with each other; no phase jump."""
        turned = self._turned(angle, self._candidate)
        gap_s = self._candidate_gap_s
        if math.isfinite(turned) and abs(turned) <= self._p.max_omega_rad_s * gap_s:
            self._agreeing += 1
            self._candidate_span_rad += turned
            self._candidate_span_s += gap_s
        else:
            self._agreeing = 1
            expected = self.omega_rad_s * self._raw_gap_s
            moved = self._turned(angle, self._raw, expected)
            self.wraps.begin(moved, expected, self._theta_at_raw)
            self._candidate_span_rad = self._candidate_span_s = 0.0
        self._candidate = angle
        self._candidate_gap_s = 0.0
        if self._agreeing < AGREEING_SAMPLES:
            return False
        self.omega_rad_s = self._candidate_span_rad / self._candidate_span_s
        self.theta_rad += self.omega_rad_s * dt_s
        self._hold_reference(angle, self.theta_rad)
        self._tracked = self.theta_rad
        self._agreeing = 0
        self._candidate = math.nan
        self.wraps.confirm()
        self._check.begin()
        self._accepted(_ENCODER)
        return True


def _index(name: str | None, channels: Mapping[str, int]) -> int:
    return -1 if name is None else channels[name]
