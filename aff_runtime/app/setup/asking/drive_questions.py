"""What is asked of the law and of the unwind's drive; the probe finds what nobody knows."""

from __future__ import annotations

from aff_runtime.app.setup.asking.draft import Draft
from aff_runtime.app.setup.asking.quantities import UNWIND
from aff_runtime.app.setup.asking.questions import NONE, Question, number, one_of


def law_question(draft: Draft) -> Question:
    """Return the choice of the law: the roll's shape, where its angle and radius are seen."""
    seen = {f"{UNWIND}_angle_rad", f"{UNWIND}_radius_m"} <= draft.found
    return Question(
        name="law",
        text="Law: shape, whose drive the probe finds where you do not know it, or blocks",
        read=one_of("shape", "blocks"),
        default="shape" if seen else "blocks",
    )


def drive_questions(draft: Draft) -> tuple[Question, ...]:
    """Return what law shape can be told of the drive; what is none the probe identifies.

    Damping belongs to a gain, width and core to a density; a tension is asked for where no set
    point says it.
    """
    asked = [
        Question(
            name="speed_gain",
            text="Speed loop: proportional gain over inertia, rad/s; none: the probe finds it",
            read=number("rad/s", 0.0, 1000.0),
            default=NONE,
        )
    ]
    if draft.answers.get("speed_gain", NONE) != NONE:
        asked.append(
            Question(name="zeta", text="Damping of the speed loop", read=number("", 0.0, 10.0))
        )
    asked += [
        Question(
            name="inertia",
            text="Inertia of core, chuck and coupling, kg m2; none: the probe finds it",
            read=number("kg m2", 0.0, 1e4),
            default=NONE,
        ),
        Question(
            name="density",
            text="Density of the wound web, kg/m3; none where it is not known",
            read=number("kg/m3", 0.0, 2e4),
            default=NONE,
        ),
    ]
    if draft.answers.get("density", NONE) != NONE:
        asked += [
            Question(name="width", text="Width of the web", read=number("m", 0.0, 20.0)),
            Question(
                name="core", text="Outer radius of the core itself", read=number("m", 0.005, 3.0)
            ),
        ]
    if "tension_ref_N" not in draft.found:
        asked.append(
            Question(name="usual_tension", text="Usual web tension", read=number("N", 0.0, 1e5))
        )
    return tuple(asked)
