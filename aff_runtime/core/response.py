"""The measured response P(f) of one actuator to one signal, and the trust in its phase."""

from __future__ import annotations

import cmath
import json
import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import asdict, dataclass

from aff_runtime.base.errors import UNREADABLE, ConfigError
from aff_runtime.base.printable import printable
from aff_runtime.core.identified import IdentifiedDrive

FORMAT = "aff-response-1"
MAX_PHASE_ERROR_RAD = math.radians(60.0)
BASE_ERROR_RAD = math.radians(3.0)  # of a phase, noise apart
# standard errors of P that its phase may be off; half of their power turns the phase, hence the
# root. An order diverges beyond 90 degrees: where the bound is 60, those are 3.5 standard errors
# of the phase (one order in two thousand)
SIGMAS = 2.3 / math.sqrt(2.0)
OUTSIDE_RAD_PER_OCTAVE = math.radians(90.0)
MIN_COHERENCE = 0.73  # 1 / (1 + e^2) at the error e whose phase is known to 60 degrees
BAND_SLACK = 1.02  # an order this little outside the probed band, by ratio, may arm
GAIN_RANGE = (1e-9, 1e12)  # signal unit per output unit; far outside what any line does
COHERENCE_ROUNDING = 1e-6  # of a coherence above 1
LONGEST_REASON = 400  # characters of a sentence in a response file
MEASURED = ("cycle_s", "amplitude", "amplitude_needed", "repeat_sigmas")


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponsePoint:
    """One measured frequency.

    ``gain`` in signal unit per output unit, ``phase_rad`` of P (all delays included),
    ``relative_error`` one standard error of P over |P|, ``coherence`` 0..1.
    """

    frequency_Hz: float
    gain: float
    phase_rad: float
    relative_error: float
    coherence: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Where a response comes from; texts and numbers for people and audits.

    ``amplitude`` is the peak of what was sent, ``amplitude_needed`` what the noise asked for, in
    the unit of the output. ``repeat_sigmas`` is how far the response is from the one before, of
    the same speed and radius, in their stated errors; NaN where there was none.
    """

    actuator: str
    signal: str
    measured_at: str = ""
    config_hash: str = ""
    version: str = ""
    line_speed_m_s: float = math.nan
    radius_m: float = math.nan
    cycle_s: float = math.nan
    amplitude: float = math.nan
    amplitude_needed: float = math.nan
    repeat_sigmas: float = math.nan


class Response:
    """P(f) between and around measured points.

    P relates the value a law returns in tick k to the signal in the snapshot of tick k, so it
    holds every delay of the way. Between points log gain and phase are linear in frequency, the
    phase after taking out ``delay_s``; outside the nearest point stands in, and the bound of the
    phase error grows by 90 degrees per octave.
    """

    __slots__ = (
        "_f",
        "_log_gain",
        "_memory_s",
        "_noise_rad",
        "_phase",
        "delay_s",
        "drive",
        "no_drive",
        "points",
        "provenance",
    )

    def __init__(
        self,
        *,
        points: Iterable[ResponsePoint],
        delay_s: float,
        provenance: Provenance,
        drive: IdentifiedDrive | None = None,
        no_drive: str = "",
    ) -> None:
        """Order the points; ConfigError when there is none or one is not a positive number.

        ``drive`` is what the same probe found of the drive itself, None where it found nothing;
        ``no_drive`` says why, as a sentence.
        """
        self.points = tuple(sorted(points, key=lambda point: point.frequency_Hz))
        if not self.points:
            raise ConfigError("a response needs at least one point; run the probe")
        for p in self.points:
            name = f"response point at {p.frequency_Hz} Hz"
            numbers = (p.frequency_Hz, p.gain, p.phase_rad, p.relative_error, p.coherence, delay_s)
            if not (all(map(math.isfinite, numbers)) and _is_possible(p)):
                raise ConfigError(f"{name} is unusable; probe again")
        self.delay_s = delay_s
        self.drive = drive
        self.no_drive = no_drive
        self.provenance = provenance
        self._f = [p.frequency_Hz for p in self.points]
        self._log_gain = [math.log(p.gain) for p in self.points]
        self._phase: list[float] = []
        for p in self.points:
            phase = p.phase_rad + math.tau * p.frequency_Hz * delay_s
            before = self._phase[-1] if self._phase else 0.0
            self._phase.append(before + math.remainder(phase - before, math.tau))
        pairs = range(max(1, len(self.points) - 1))  # point i and the next one
        self._memory_s = [self._memory_of(i) for i in pairs]
        noise = [max(p.relative_error for p in self.points[i : i + 2]) for i in pairs]
        self._noise_rad = [BASE_ERROR_RAD + SIGMAS * worst for worst in noise]

    def _memory_of(self, i: int) -> float:
        """Return |dlnP/dw| between point ``i`` and the next one, s."""
        pair = slice(i, i + 2)
        if len(self._f[pair]) == 1:
            return abs(self.delay_s)
        (f, f_next), (phase, later) = self._f[pair], self._phase[pair]
        gain, next_gain = self._log_gain[pair]
        width = math.tau * (f_next - f)
        if width <= 0.0:
            return abs(self.delay_s)
        return math.hypot((later - phase) / width - self.delay_s, (next_gain - gain) / width)

    @property
    def band_Hz(self) -> tuple[float, float]:
        """Lowest and highest measured frequency."""
        return self._f[0], self._f[-1]

    def _between(self, frequency_Hz: float) -> tuple[int, float]:
        """Return the point below and how far on the way to the next, 0..1; clamped to the band."""
        last = len(self._f) - 1
        if last == 0 or frequency_Hz <= self._f[0]:
            return 0, 0.0
        if frequency_Hz >= self._f[last]:
            return last - 1, 1.0
        i = bisect_right(self._f, frequency_Hz) - 1
        return i, (frequency_Hz - self._f[i]) / (self._f[i + 1] - self._f[i])

    def nearest(self, frequency_Hz: float) -> ResponsePoint:
        """Return the point nearest to a frequency; the lower of two that are equally near."""
        above = bisect_left(self._f, frequency_Hz)
        if above == 0:
            return self.points[0]
        below = bisect_left(self._f, self._f[above - 1])  # the first of equal frequencies
        if above == len(self._f):
            return self.points[below]
        is_below = frequency_Hz - self._f[below] <= self._f[above] - frequency_Hz
        return self.points[below if is_below else above]

    def _lerp(self, table: list[float], i: int, share: float) -> float:
        return table[i] if share == 0.0 else table[i] + share * (table[i + 1] - table[i])

    def at(self, frequency_Hz: float) -> complex:
        """Return P at a frequency; its conjugate at the negative one (a roll that reverses)."""
        f = abs(frequency_Hz)
        i, share = self._between(f)
        phase = self._lerp(self._phase, i, share) - math.tau * f * self.delay_s
        gain = math.exp(self._lerp(self._log_gain, i, share))
        return cmath.rect(gain, phase if frequency_Hz >= 0.0 else -phase)

    def memory_s(self, frequency_Hz: float) -> float:
        """Return |dlnP/dw|, s: how long P remembers near a frequency, group delay included."""
        return self._memory_s[self._between(abs(frequency_Hz))[0]]

    def phase_error_bound_rad(self, frequency_Hz: float) -> float:
        """Return a bound of the error of arg P: noise, interpolation, distance from the band."""
        f = abs(frequency_Hz)
        if not f > 0.0:
            return math.pi
        i, share = self._between(f)
        bound = self._noise_rad[i]
        if 0.0 < share < 1.0:
            bound += share * (1.0 - share) * abs(self._phase[i + 1] - self._phase[i])
        if self._f[0] <= f <= self._f[-1]:
            return min(bound, math.pi)
        outside = max(self._f[0] / f, f / self._f[-1], 1.0)
        bound += OUTSIDE_RAD_PER_OCTAVE * math.log2(outside)
        return min(bound, math.pi)

    def to_json(self) -> str:
        """Return the response as text, one point per line item, readable back by ``from_json``."""
        provenance = {
            k: None if isinstance(v, float) and math.isnan(v) else v
            for k, v in asdict(self.provenance).items()
        }
        said = {
            "format": FORMAT,
            "delay_s": self.delay_s,
            "provenance": provenance,
            "points": [asdict(point) for point in self.points],
            **({} if self.drive is None else {"drive": self.drive.to_plain()}),
            **({"no_drive": self.no_drive} if self.no_drive else {}),
        }
        return json.dumps(said, indent=1, allow_nan=False)

    @classmethod
    def from_json(cls, text: str) -> Response:
        """Read ``to_json``'s text; ConfigError says what is wrong with any other."""
        try:
            data = json.loads(text)
            if data["format"] != FORMAT:
                raise ConfigError(f"response format {data['format']!r}, need {FORMAT!r}")
            kept = {k: v for k, v in data["provenance"].items() if v is not None}
            kept |= {k: float(v) for k, v in kept.items() if k in MEASURED}
            points = [ResponsePoint(**{k: float(v) for k, v in p.items()}) for p in data["points"]]
            drive = data.get("drive")
            return cls(
                points=points,
                delay_s=float(data["delay_s"]),
                provenance=Provenance(**kept),
                drive=None if drive is None else IdentifiedDrive.from_plain(drive),
                no_drive=printable(str(data.get("no_drive", "")), LONGEST_REASON),
            )
        except UNREADABLE as error:
            raise ConfigError(f"not a response file: {error}; run the probe again") from error


def _is_possible(point: ResponsePoint) -> bool:
    """Return whether a line can have answered so; a probe never leaves these ranges."""
    return (
        point.frequency_Hz > 0.0
        and GAIN_RANGE[0] <= point.gain <= GAIN_RANGE[1]
        and point.relative_error >= 0.0
        and 0.0 <= point.coherence <= 1.0 + COHERENCE_ROUNDING
    )


def arming_objections(
    response: Response | None, wanted_Hz: Iterable[tuple[str, float]]
) -> tuple[str, ...]:
    """Return why an actuator may not arm, one sentence each; empty when it may.

    ``wanted_Hz`` names every enabled order and its present frequency.
    """
    if response is None:
        return ("no measured response; run the probe",)
    objections: list[str] = []
    low, high = response.band_Hz
    for name, signed_Hz in wanted_Hz:
        f = abs(signed_Hz)
        if not f > 0.0:
            objections.append(f"{name}: its roll does not turn, or its angle is not known")
            continue
        if not low / BAND_SLACK <= f <= high * BAND_SLACK:
            objections.append(f"{name}: {f:.2f} Hz is outside the probed {low:.2f}..{high:.2f} Hz")
        bound = response.phase_error_bound_rad(f)
        if bound > MAX_PHASE_ERROR_RAD:
            degrees = math.degrees(bound)
            objections.append(f"{name}: phase error at {f:.2f} Hz may reach {degrees:.0f} deg")
        nearest = response.nearest(f)
        if nearest.coherence < MIN_COHERENCE:
            objections.append(
                f"{name}: coherence {nearest.coherence:.2f} near {f:.2f} Hz is too low"
            )
    return tuple(objections)
