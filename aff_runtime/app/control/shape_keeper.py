"""Learned shapes across starts: saved ones are tried before use, newly learned ones are kept.

Lives in the control process. Trying costs a lock-in per column and tick and happens only while
nothing goes out; saving sends one message when an output has closed.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from aff_runtime.app.control.known_shape import (
    KnownShape,
    PerOrder,
    at_origin,
    imbalance_at,
    trial_words,
    with_imbalance,
)
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.wiring.shape_file import (
    WAITS,
    ShapeFile,
    response_hash,
    shape_basis_hash,
    start_values,
)
from aff_runtime.base.clock import wall_time_iso
from aff_runtime.core.controller import Controller, RollPhases
from aff_runtime.core.params import SiteParams
from aff_runtime.core.phase import Quality
from aff_runtime.core.shape.law import ShapeLaw
from aff_runtime.core.shape.profile import ShapeProfile
from aff_runtime.core.shape.trial import TURNS, ShapeTrial

KEPT_AFTER_TURNS = 3.0  # with a correction, of the slowest roll
RADIUS_UP, RADIUS_DOWN = 1.01, 0.85  # of the saved radius: beyond, it is another roll


@dataclass(slots=True)
class _Trial:
    """One law that could start from a known shape; ``fed_s`` : readings for its trial so far."""

    known: list[KnownShape]
    fed_s: float = 0.0
    trial: ShapeTrial | None = None


class ShapeKeeper:
    """Starts laws from saved or given shapes, and hands on what they have learned.

    Parameters
    ----------
    parameters : parameter record; ``shapes`` are the texts of the shape files.
    tell : takes (actuator, sentence): what became of a shape.
    keep : takes (actuator, text of a shape file).
    """

    def __init__(
        self,
        parameters: ParameterRecord,
        *,
        tell: Callable[[str, str], None],
        keep: Callable[[str, str], None],
    ) -> None:
        self._tell, self._keep = tell, keep
        self._version = parameters.version
        self._shapes = dict(parameters.shapes)
        self._active_turns = 0.0
        self._roll_id: int | None = None
        self._active_roll_id: int | None = None
        self._trials: dict[str, _Trial] = {}
        self._tried: set[str] = set()  # actuators whose trial is over or was given up
        self._forgotten: dict[str, PerOrder] = {}  # of the site file's start shapes, m
        self._announced: set[str] = set()
        self._told_of_response: set[tuple[str, str]] = set()  # (actuator, response)
        self.follow(parameters)

    def follow(self, parameters: ParameterRecord) -> None:
        """Go on with another parameter record; trials under way begin anew.

        An actuator whose trial is over, or was given up, is not tried again.
        """
        site = self._site = parameters.site
        self._config_hash = parameters.config_hash
        self._hash = {name: shape_basis_hash(site, name) for name in site.actuators}
        measured = parameters.responses
        self._response = {name: response_hash(measured.get(name)) for name in site.actuators}
        self._trials.clear()
        for name in site.actuators:
            if name in self._tried:
                continue
            known = self._known(name, start_values(site, name))
            if known:
                self._trials[name] = _Trial(known)
                self._announce(name, known[0].source)

    def _announce(self, name: str, source: str) -> None:
        """Say once what the trial needs, so that nobody arms before it by mistake."""
        if name not in self._announced:
            self._announced.add(name)
            memory_s = self._site.actuators[name].response_memory_s
            turns = f"{TURNS:.0f} turns of every roll"
            needs = f"it takes {memory_s:.0f} s and {turns} with the line running"
            self._tell(name, f"{source} {WAITS}: {needs}; arm after that")

    def _known(self, actuator: str, given: PerOrder) -> list[KnownShape]:
        """Return shapes to try for one actuator, the best first."""
        known: list[KnownShape] = []
        if actuator in self._shapes:
            file = ShapeFile.from_json(self._shapes[actuator])
            if file.belongs_to == self._hash[actuator]:
                known.append(
                    KnownShape(
                        source=f"the shape saved {file.saved_at}",
                        weight_m=file.profile.weight_m,
                        response_ratio_less_1=self._response_ratios_less_1(actuator, file),
                        imbalance_m=file.profile.imbalance_m,
                        file=file,
                    )
                )
            else:
                other = "other rolls, or another encoder, drive or signal"
                text = f"the saved shape was learned with {other}; the rolls are learned anew"
                self._tell(actuator, text)
                del self._shapes[actuator]
        forgotten = self._forgotten.get(actuator, {})
        given = {key: w for key, w in given.items() if forgotten.get(key) != w}
        source = "the start shape of the site file"
        known.append(KnownShape(source=source, weight_m=given, response_ratio_less_1={}))
        return [shape for shape in known if shape.weight_m]

    def _response_ratios_less_1(self, actuator: str, file: ShapeFile) -> PerOrder:
        """Return a file's response ratios less 1; none that were learned over another response.

        The trial would take ratios to another response for a moved encoder.
        """
        if file.response and file.response == self._response[actuator]:
            return file.profile.response_ratio_less_1
        if (actuator, self._response[actuator]) in self._told_of_response:
            return {}
        self._told_of_response.add((actuator, self._response[actuator]))
        whose = "of another response" if file.response else "of a response that it does not name"
        text = f"the shape saved {file.saved_at} keeps its shape; its correction of P is {whose}"
        self._tell(actuator, f"{text} and is learned anew")
        return {}

    # --- before anything goes out ---------------------------------------------------------------

    def feed_trials(
        self, controller: Controller, values: Sequence[float], *, fresh: bool, quiet: bool
    ) -> None:
        """Take one tick while shapes wait for their trial; cheap when none does.

        ``values`` are the snapshot's channels; ``quiet`` : every output is closed and zero. A
        trial begins anew after an angle was lost: it may go on from another origin, and the
        filter that ``law.seen`` returns still holds what was predicted meanwhile.
        """
        if not self._trials:
            return
        lost = any(p.quality is Quality.LOST for p in controller.phases.by_name.values())
        laws = controller.shape_laws()
        for name in list(self._trials):
            law = laws.get(name)
            if law is None:
                continue  # the plain blocks stand in until there is a response
            if any(law.weights().values()):
                self._drop(name)
                continue
            if lost or not (quiet and law.is_open):
                self._trials[name].fed_s, self._trials[name].trial = 0.0, None
            elif fresh:
                self._feed_trial(name, law, controller, values)

    def _drop(self, name: str) -> None:
        """Give up a trial: the law has learned meanwhile, by an early ``arm``."""
        self._tried.add(name)
        waiting = self._trials.pop(name)
        for known in waiting.known:
            if known.weight_m:
                text = "learning began before its trial was over; the roll is learned anew"
                self._tell(name, f"{known.source} is not used: {text}")

    def _feed_trial(
        self, name: str, law: ShapeLaw, controller: Controller, values: Sequence[float]
    ) -> None:
        waiting = self._trials[name]
        site_params = controller.site
        signal, reference = _readings(site_params, name, values)
        followed = all(p.quality is Quality.GOOD for p in controller.phases.by_name.values())
        if not followed or not math.isfinite(signal - reference):
            return
        waiting.fed_s += site_params.cycle_s
        if waiting.fed_s < self._site.actuators[name].response_memory_s:
            return  # the filter that ``law.seen`` returns is still filling
        if waiting.trial is None:
            waiting.trial = ShapeTrial(
                [roll for roll, _ in law.keys], [order for _, order in law.keys], law.signal_sd
            )
        count = len(law.keys)
        phi = law.seen()[:count]
        turn_s = law.basis.turn_s[:count]
        waiting.trial.step(signal - reference, phi, turn_s, site_params.cycle_s)
        if waiting.trial.done:
            del self._trials[name]
            self._decide(name, law, controller.phases, waiting)

    def _decide(self, name: str, law: ShapeLaw, phases: RollPhases, waiting: _Trial) -> None:
        """Start from what fits, roll by roll, and say what became of the rest."""
        assert waiting.trial is not None
        start: dict[tuple[str, int], complex] = {}
        response_ratio_less_1: dict[tuple[str, int], complex] = {}
        imbalance: dict[str, complex] = {}
        self._tried.add(name)
        for roll in dict.fromkeys(roll for roll, _ in law.keys):
            for known in waiting.known:
                if not any(known_roll == roll for known_roll, _ in known.weight_m):
                    continue
                if (text := self._misfit(roll, known, phases)) is not None:
                    self._tell(name, f"{roll}: {known.source} is not used: {text}")
                    continue
                weight, learned = at_origin(law, roll, known, phases)
                imbalance_m = imbalance_at(roll, known, phases)
                fit = waiting.trial.fit(
                    roll, with_imbalance(law, roll, weight, imbalance_m), learned
                )
                self._tell(name, f"{roll}: {trial_words(known.source, fit)}")
                if not fit.fits:
                    continue
                for i, key in enumerate(law.keys):
                    if key[0] == roll and key in known.weight_m:
                        start[key] = weight[i] * cmath.exp(-1j * key[1] * fit.turned_rad)
                        if key in known.response_ratio_less_1:
                            response_ratio_less_1[key] = complex(learned[i])
                if imbalance_m:
                    imbalance[roll] = imbalance_m * cmath.exp(-1j * fit.turned_rad)
                break
        law.start_from(
            ShapeProfile(
                weight_m=start, response_ratio_less_1=response_ratio_less_1, imbalance_m=imbalance
            )
        )

    def _misfit(self, roll: str, known: KnownShape, phases: RollPhases) -> str | None:
        """Return why the shape cannot be this roll's; None when it can."""
        file = known.file
        if file is None or self._site.rolls[roll].resets_on != "splice":
            return None
        if phases.roll_id != file.roll_id:
            return f"it is of roll {file.roll_id}, now there is roll {phases.roll_id}"
        saved_m, now_m = file.radius_m.get(roll, math.nan), phases.by_name[roll].radius_m
        if not RADIUS_DOWN * saved_m <= now_m <= RADIUS_UP * saved_m:
            return f"it was learned at radius {saved_m:.4f} m, now it is {now_m:.4f} m"
        return None

    # --- when an output has closed --------------------------------------------------------------

    def save_when_closed(
        self,
        controller: Controller,
        *,
        active: bool,
        quiet: bool,
        unbelieved: frozenset[str],
        elapsed_s: float,
    ) -> None:
        """Count turns with a correction; hand the shapes on once it is zero again.

        Parameters
        ----------
        active : a correction goes out. ``quiet`` : every output is closed and zero.
        unbelieved : actuators that made ripple rise and whose weights are about to be dropped.
        elapsed_s : since the last call.
        """
        self._see_roll(controller)
        if active:
            self._active_roll_id = controller.phases.roll_id
            self._active_turns += elapsed_s * controller.slowest_omega_rad_s / math.tau
        elif quiet and self._active_turns > 0.0:
            turns, self._active_turns = self._active_turns, 0.0
            if turns >= KEPT_AFTER_TURNS:
                self._save(controller, unbelieved)

    def _see_roll(self, controller: Controller) -> None:
        """Say that a new roll was put in."""
        phases, before = controller.phases, self._roll_id
        self._roll_id = phases.roll_id
        if before is None or before == phases.roll_id:
            return
        for name, law in controller.shape_laws().items():
            removed = [roll for roll in phases.spliced if any(r == roll for r, _ in law.keys)]
            if removed:
                now = "an unknown roll" if phases.roll_id is None else f"roll {phases.roll_id}"
                text = f"{now} in the place of roll {before}"
                self._tell(name, f"{text}: the shape of {', '.join(removed)} is forgotten")

    def close(self, controller: Controller) -> None:
        """Hand on what was learned; the control process ticks no more."""
        self.save_when_closed(
            controller, active=False, quiet=True, unbelieved=frozenset(), elapsed_s=0.0
        )

    def _save(self, controller: Controller, unbelieved: frozenset[str]) -> None:
        phases = controller.phases
        # of a roll that was exchanged while the output closed, nothing is worth keeping
        removed = phases.spliced if phases.roll_id != self._active_roll_id else ()
        for name, law in controller.shape_laws().items():
            profile = law.profile()
            kept = {k: w for k, w in profile.weight_m.items() if w != 0j and k[0] not in removed}
            origin = {roll: phases.by_name[roll].origin_rad for roll, _ in kept}
            if not kept or name in unbelieved or not all(map(math.isfinite, origin.values())):
                continue
            imbalance_m = {
                roll: w * cmath.exp(1j * origin[roll])
                for roll, w in profile.imbalance_m.items()
                if roll in origin
            }
            turned = {(r, n): w * cmath.exp(1j * n * origin[r]) for (r, n), w in kept.items()}
            drive = self._site.actuators[name].drive
            file = ShapeFile(
                actuator=name,
                belongs_to=self._hash[name],
                response=self._response[name],
                config_hash=self._config_hash,
                saved_at=wall_time_iso(),
                version=self._version,
                roll_id=phases.roll_id or 0,
                radius_m={roll: phases.by_name[roll].radius_m for roll in origin},
                web={
                    "density_kg_m3": drive.web_density_kg_m3 if drive else 0.0,
                    "width_m": drive.web_width_m if drive else 0.0,
                },
                profile=ShapeProfile(
                    weight_m=turned,
                    response_ratio_less_1=profile.response_ratio_less_1,
                    imbalance_m=imbalance_m,
                ),
            )
            try:
                self._keep(name, file.to_json())
            except ValueError:
                self._tell(name, "the learned shape is not finite and is not saved")

    def forget(self, controller: Controller, rolls: Collection[str] = ()) -> frozenset[str]:
        """Drop what every law has learned of some rolls, and the shapes that it could start from.

        Without ``rolls`` : of every roll that a splice exchanges (``resets_on: splice``).

        Returns
        -------
        frozenset[str] : those of which a law had learned something, or a shape waited.
        """
        exchanged = frozenset(rolls or controller.phases.spliced)
        known = exchanged & (controller.learned_rolls() | self._waiting_rolls())
        self._forget_shapes(exchanged)
        controller.forget_rolls(exchanged)
        return known

    def _waiting_rolls(self) -> frozenset[str]:
        """Return the rolls of which a shape waits for its trial."""
        waiting = (shape for trial in self._trials.values() for shape in trial.known)
        return frozenset(roll for shape in waiting for roll, _ in shape.weight_m)

    def _forget_shapes(self, exchanged: Collection[str]) -> None:
        for name, text in self._shapes.items():
            self._shapes[name] = ShapeFile.from_json(text).without(exchanged).to_json()
        for name in self._site.actuators:
            given = start_values(self._site, name)
            dropped = {k: w for k, w in given.items() if k[0] in exchanged}
            self._forgotten[name] = {**self._forgotten.get(name, {}), **dropped}
        for name, waiting in list(self._trials.items()):
            for known in waiting.known:
                known.forget(exchanged)
            if not any(known.weight_m for known in waiting.known):
                del self._trials[name]


def _readings(site_params: SiteParams, name: str, values: Sequence[float]) -> tuple[float, float]:
    """Return signal and reference of an actuator; the declared tension without a channel."""
    actuator = next(a for a in site_params.actuators if a.name == name)
    signal = values[site_params.channels.index(actuator.signal)]
    if actuator.reference is not None:
        return signal, values[site_params.channels.index(actuator.reference)]
    return signal, actuator.drive.tension_N if actuator.drive is not None else 0.0
