"""A splice after which the web is another one."""

from __future__ import annotations

from collections.abc import Mapping

from sim_plant.base.arrays import LineArrays
from sim_plant.base.effects import Effect, Form, Parameter, Value
from sim_plant.base.signatures import Onset


def apply(arrays: LineArrays, place: int, parameters: Mapping[str, Value]) -> LineArrays:
    """Change EA and thickness for all web beyond ``at_length_m`` of unstretched web unwound.

    A span with both webs is two springs in series at one tension; what leaves it has the strain
    of the web at its exit [own, from source 2.20]. The splice passes spans and wraps with the
    web. The new web was wound at the same tension. The length counts from the start of the
    record: speed times time, to strain.

    The seam itself, ``piece_m`` long, may be thicker: while a part of it is on a roller the web
    runs ``step_m`` further out, so that the roller carries (R + step) w and is pulled at that arm
    [own].
    """
    web = arrays.web
    web["splice_EA_ratio"] *= float(parameters["EA_factor"])
    web["splice_thickness_ratio"] *= float(parameters["thickness_factor"])
    if float(parameters["EA_factor"]) != 1.0 or float(parameters["thickness_factor"]) != 1.0:
        web["splice_m"] = float(parameters["at_length_m"])
    if float(parameters["step_m"]) != 0.0:
        web["splice_m"] = float(parameters["at_length_m"])
        web["splice_step_m"] += float(parameters["step_m"])
        web["splice_piece_m"] = float(parameters["piece_m"])
    return arrays


def beside(there: Mapping[str, Value], more: Mapping[str, Value]) -> str:
    """Return that a line has one splice at a time; what is said of the same one adds."""
    if not (_is_there(there) and _is_there(more)):
        return ""
    if there["at_length_m"] != more["at_length_m"]:
        return f"at {there['at_length_m']} m, and a line has one splice"
    seams = float(there["step_m"]) != 0.0 and float(more["step_m"]) != 0.0
    if seams and there["piece_m"] != more["piece_m"]:
        return f"with a seam of {there['piece_m']} m"
    return ""


def _is_there(values: Mapping[str, Value]) -> bool:
    webs = float(values["EA_factor"]) != 1.0 or float(values["thickness_factor"]) != 1.0
    return webs or float(values["step_m"]) != 0.0


EFFECT = Effect(
    name="splice",
    place="web",
    candidates="web",
    accepts={
        "EA_factor": Parameter(default=1.0, unit="1", typical=0.9, low=0.3, high=3.0, linear=True),
        "thickness_factor": Parameter(
            default=1.0, unit="1", typical=1.1, low=0.3, high=3.0, linear=True
        ),
        "step_m": Parameter(
            default=0.0, unit="m", typical=2e-4, low=-0.005, high=0.005, linear=True
        ),
        "piece_m": Parameter(
            default=0.05,
            unit="m",
            typical=0.05,
            low=0.005,
            high=1.0,
            role="shape",
            known_to=0.01,  # web bridges sqrt(2 R step) at either edge: 6 mm of 0.5 mm at 40 mm
        ),
        "at_length_m": Parameter(
            default=0.0,
            unit="m",
            typical=30.0,
            low=0.0,
            high=1e5,
            role="shape",
            step=0.003,  # an edge of a seam is 10 mm long
            known_to="sample",
        ),
    },
    fitted=(),
    apply=apply,
    text="from a splice on the web is another one: tensions change zone by zone as it passes",
    shows=None,
    beside=beside,
    onset=Onset(
        moment="at_length_m",
        unit="m",
        forms=(("step_m", "piece_m"), ("EA_factor", "thickness_factor")),
        grid=(("piece_m", (0.05, 0.1)),),
    ),
    forms=(
        Form(
            strengths=("step_m",),
            text="a seam of another thickness is on the web: each roller pulls at another arm "
            "while the seam runs over it",
            remedy="look at the seam at that length of web: its overlap and its tape",
        ),
    ),
    remedy="judge the webs before and after the splice on their own",
)
