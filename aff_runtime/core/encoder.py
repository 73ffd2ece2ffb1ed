"""Is the encoder of a roll to be believed? Asked of the speed channel, while the line moves."""

from __future__ import annotations

import math
from enum import Enum

STUCK_CHECK_RAD = 0.5
"""The encoder is judged over as much motion by the speed channel."""
STUCK_SHARE = 0.3
"""An encoder that turned by a smaller share of that motion is out of service."""
CREDIBLE_SHARE = 0.7
"""One that turned by a larger share is back in service."""
CHANGES_SHARE = 0.02
"""A speed that changes by more over those 0.5 rad may lag behind the roll, or lead it, and takes
no encoder out of service.

A speed that is filtered with tau coasts omega tau after a stop at omega, and has fallen by
0.5 rad / (omega tau) over the first 0.5 rad: by 2 % where it coasts four turns. At a start the
line runs on while a dancer's stroke or slack web feeds it, and the roll follows later.
"""
TAIL_S = 2.0  # a stop so soon after an encoder went out of service was what held it
STOOD_S = 1.0  # of standing, after which no law sends anything (``gate.RAMP_S`` is half of it)


class Trust(Enum):
    """Whether an encoder is believed after one reading."""

    BELIEVED = 1
    OUT = 2
    STOOD = 3
    """It only stood with the line: back in service, with the origin that it had."""


_BELIEVED, _OUT = Trust.BELIEVED, Trust.OUT


class EncoderCheck:
    """Compares what an encoder turns with the speed channel: a frozen one is out of service.

    A line that stands says nothing about an encoder: the speed channel has an offset, and a
    filtered one goes on after a stop, while the encoder rightly stands.

    Attributes
    ----------
    in_service : whether the encoder is believed.
    ratio : how far it went over a turn by the speed channel; NaN before that.
    """

    __slots__ = (
        "_encoder_rad",
        "_encoder_turn_rad",
        "_first_rad_s",
        "_model_rad",
        "_model_turn_rad",
        "_out_s",
        "_stood_s",
        "in_service",
        "ratio",
    )

    def __init__(self) -> None:
        self.ratio = math.nan
        self._encoder_turn_rad = self._model_turn_rad = 0.0
        self.begin()

    def begin(self) -> None:
        """Believe the encoder, from here on: it has a new origin."""
        self.in_service = True
        self._encoder_rad = self._model_rad = self._first_rad_s = 0.0
        self._out_s = self._stood_s = 0.0

    def judge(
        self, turned_rad: float, speed_rad_s: float, gap_s: float, stands_below_rad_s: float
    ) -> Trust:
        """Take one reading, ``gap_s`` after the last; ``speed_rad_s`` is by the speed channel.

        Below ``stands_below_rad_s`` the roll stands; NaN: nobody knows from where on.
        """
        if not math.isfinite(speed_rad_s):
            self.in_service = True
            return _BELIEVED
        if abs(speed_rad_s) < stands_below_rad_s:
            return self._stand(gap_s)
        self._stood_s = 0.0
        if not self.in_service:
            self._out_s += gap_s
        model_rad = speed_rad_s * gap_s
        if self._model_rad == 0.0:
            self._first_rad_s = abs(speed_rad_s)
        self._encoder_rad += turned_rad
        self._model_rad += model_rad
        self._encoder_turn_rad += turned_rad
        self._model_turn_rad += model_rad
        if abs(self._model_turn_rad) >= math.tau:
            self.ratio = self._encoder_turn_rad / self._model_turn_rad
            self._encoder_turn_rad = self._model_turn_rad = 0.0
        if abs(self._model_rad) >= STUCK_CHECK_RAD:
            change_rad_s = abs(abs(speed_rad_s) - self._first_rad_s)
            self._decide(change_rad_s > CHANGES_SHARE * self._first_rad_s)
        return _BELIEVED if self.in_service else _OUT

    def _stand(self, gap_s: float) -> Trust:
        """Begin the judgement anew; after a stop an encoder that went out with it is right."""
        self._encoder_rad = self._model_rad = 0.0
        self._stood_s += gap_s
        if self.in_service:
            return _BELIEVED
        if self._stood_s < STOOD_S or self._out_s > TAIL_S:
            return _OUT
        self.begin()
        return Trust.STOOD

    def _decide(self, changes: bool) -> None:
        """Take the encoder out of service or back; ``changes``: the speed did, so never out."""
        share = self._encoder_rad / self._model_rad
        self._encoder_rad = self._model_rad = 0.0
        if share > CREDIBLE_SHARE:
            self.in_service = True
        elif share < STUCK_SHARE and self.in_service and not changes:
            self.in_service = False
            self._out_s = 0.0
