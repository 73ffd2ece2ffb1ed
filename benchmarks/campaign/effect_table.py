"""What the campaign knows of every effect: one row each, and the only place that names one."""

from __future__ import annotations

from benchmarks.campaign import beyond, effects
from benchmarks.campaign.beyond_table import BEYOND
from benchmarks.campaign.effect_row import EffectRow, Form, size_is
from benchmarks.campaign.fault import CELLS, DRIVES, IDLERS
from benchmarks.campaign.sensing import TICK_S

ROLLERS = (*IDLERS, "swrap", "pull_roll")
ZONES = ("unwind_zone", "pull_roll_zone", "rewind_zone")
LATER = "from a moment on"

EFFECTS = (
    EffectRow(
        name="eccentric_roller",
        change=effects.eccentric,
        drawn_at=ROLLERS,
        forms=(Form(first_size=2e-5, proportional=True, told=size_is("eccentricity_m")),),
        in_ablations=True,
        taken_out=True,
        line="turn",
        alike="one line",
        rival_at=ROLLERS,
    ),
    EffectRow(
        name="out_of_round_roll",
        change=effects.out_of_round,
        drawn_at=("unwind", "unwind", "rewind"),
        forms=(Form(first_size=1e-4, shapes=(1.0, 2.0, 3.0, 0.0), told=lambda _: {}),),
        in_ablations=True,
        taken_out=True,
        line="turn",
        order=lambda shape: max(1.0, shape),
        put_last=True,
    ),
    EffectRow(
        name="unbalanced_roller",
        change=effects.unbalanced,
        drawn_at=("R1", "R3", "swrap", "pull_roll"),
        forms=(Form(first_size=5e-3, proportional=True, told=size_is("unbalance_kg_m")),),
        in_ablations=True,
        line="turn",
        alike="one line",
        rival_at=ROLLERS,
    ),
    EffectRow(
        name="unbalanced_measuring_roller",
        change=effects.unbalanced_cell,
        drawn_at=tuple(CELLS),
        forms=(Form(first_size=3e-4, proportional=True, told=size_is("unbalance_kg_m")),),
        line="turn",
        alike="one line",
        rival_at=tuple(CELLS),
        said_as="unbalanced_roller",
    ),
    EffectRow(
        name="torque_ripple",
        change=effects.ripple,
        drawn_at=tuple(DRIVES),
        forms=(
            Form(
                first_size=0.1,
                shapes=(2.0, 3.0, 4.0, 5.0, 6.0, 8.0),
                proportional=True,
                told=size_is("amplitude_N_m"),
            ),
        ),
        in_ablations=True,
        taken_out=True,
        line="turn",
        order=lambda shape: shape,
        alike="one line",
        rival_at=tuple(DRIVES),
        rival_shapes=(2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 1.0),
    ),
    EffectRow(
        name="bearing_drag",
        change=effects.drag,
        drawn_at=tuple(IDLERS),
        forms=(
            Form(first_size=0.01, largest=0.2, proportional=True, told=size_is("constant_N_m")),
            Form(
                name=LATER,
                first_size=0.01,
                largest=0.2,
                proportional=True,
                begins=True,
                told=size_is("constant_N_m"),
            ),
        ),
        alike="standing",
        rival_at=tuple(IDLERS),
        standing=True,
    ),
    EffectRow(
        name="web_modulus",
        change=effects.modulus,
        drawn_at=("web",),
        forms=(Form(first_size=0.1, either_sign=True, largest=0.5, told=size_is("factor", 1.0)),),
        alike="standing",
        rival_at=("web",),
        standing=True,
    ),
    EffectRow(
        name="viscoelastic_web",
        change=effects.relaxing,
        drawn_at=("web",),
        forms=(
            Form(
                first_size=0.05,
                largest=1.0,
                numbers=(("time_s", (0.1, 4.0)),),
                told=lambda f: {"ratio": (f.size, 0.0), "time_s": (f.number("time_s"), 0.0)},
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="wound_in_strain",
        change=effects.wound_in,
        drawn_at=("unwind",),
        forms=(
            Form(
                first_size=1e-3,
                either_sign=True,
                largest=5e-3,
                proportional=True,
                told=size_is("strain"),
            ),
        ),
        alike="standing",
        rival_at=("unwind",),
        standing=True,
    ),
    EffectRow(
        name="thermal_strain",
        change=effects.thermal,
        forms=(
            Form(
                drawn_at=("pull_roll_zone",),
                first_size=5e-5,
                largest=2e-3,
                proportional=True,
                told=size_is("strain"),
            ),
            Form(
                name=LATER,
                drawn_at=ZONES,
                first_size=5e-5,
                largest=2e-3,
                numbers=(("rise_s", (0.3, 2.0)), ("hold_s", (6.0, 40.0))),
                proportional=True,
                begins=True,
                told=size_is("strain"),
            ),
        ),
        alike="standing",
        rival_at=ZONES,
        standing=True,
    ),
    EffectRow(
        name="slip",
        change=effects.slip,
        drawn_at=("swrap", "pull_roll"),
        forms=(
            Form(
                first_size=2e-4,
                shapes=(0.8, 1.0),
                largest=5e-3,
                told=lambda f: {"slope_s_m": (f.size, 0.0), "threshold_m_s": (f.shape, 0.0)},
            ),
            Form(
                name=LATER, first_size=2e-4, largest=5e-3, begins=True, told=size_is("slope_s_m")
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="splice",
        change=effects.other_web,
        drawn_at=("web",),
        forms=(
            Form(
                name="another web",
                first_size=0.05,
                largest=0.5,
                either_sign=True,
                numbers=(("thickness_factor", (0.9, 1.12)),),
                begins=True,
                told=size_is("EA_factor", 1.0),
            ),
            Form(
                name="a thick seam",
                change=effects.thick_seam,
                first_size=2e-4,
                largest=2e-3,
                numbers=(("piece_m", (0.03, 0.12)),),
                begins=True,
                proportional=True,
                told=size_is("step_m"),
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="roll_bounce",
        change=effects.bouncing,
        drawn_at=("unwind",),
        forms=(
            Form(
                first_size=5e-3,
                least=2e-3,
                largest=0.5,
                shapes=(2.0, 3.0, 4.0, 5.0),
                numbers=(
                    ("mass_kg", (14.0, 30.0)),
                    ("frequency_Hz", (2.4, 5.0)),
                    ("damping", (0.04, 0.1)),
                ),
                told=lambda f: {"frequency_Hz": (f.number("frequency_Hz"), 0.0)},
            ),
        ),
        line="turn",
        order=lambda shape: shape,
    ),
    EffectRow(
        name="load_cell_filter",
        change=effects.slow_cell,
        drawn_at=("R2", "R7", "all"),
        forms=(Form(first_size=0.03, largest=0.2, told=size_is("lag_s")),),
        standing=True,
    ),
    EffectRow(
        name="load_cell_resonance",
        change=effects.ringing_cell,
        drawn_at=tuple(CELLS),
        forms=(
            Form(
                first_size=0.06,
                least=0.02,
                largest=0.4,
                numbers=(("damping", (0.03, 0.2)),),
                told=lambda f: {"frequency_Hz": (1.0 / f.size, 0.0)},
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="load_cell_calibration",
        change=effects.wrong_zero,
        drawn_at=tuple(CELLS),
        forms=(
            Form(
                name="zero",
                first_size=1.0,
                largest=10.0,
                either_sign=True,
                proportional=True,
                told=size_is("offset_N"),
            ),
            Form(
                name="gain",
                change=effects.wrong_gain,
                first_size=0.01,
                largest=0.15,
                either_sign=True,
                told=size_is("gain", 1.0),
            ),
        ),
        alike="standing",
        rival_at=tuple(CELLS),
        standing=True,
    ),
    EffectRow(
        name="mains_hum",
        change=effects.hum,
        drawn_at=tuple(CELLS),
        forms=(
            Form(
                first_size=0.2,
                shapes=(60.0, 120.0),
                proportional=True,
                told=size_is("amplitude_N"),
            ),
        ),
        taken_out=True,
        line="time",
        coordinate=beyond.alias,
    ),
    EffectRow(
        name="shaft_compliance_backlash",
        change=effects.soft_shaft,
        drawn_at=tuple(DRIVES),
        forms=(
            Form(
                name="twist",
                first_size=3e-3,
                least=5e-4,
                largest=2e-2,
                told=size_is("compliance_rad_N_m"),
            ),
            Form(
                name="twist and play",
                first_size=3e-3,
                least=5e-4,
                largest=2e-2,
                numbers=(("backlash_rad", (1e-3, 6e-3)),),
                told=size_is("compliance_rad_N_m"),
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="nip_pulse",
        change=effects.pressed,
        drawn_at=("swrap", "pull_roll"),
        forms=(
            Form(
                first_size=30.0,
                shapes=(0.03, 0.04, 0.0501, 0.0599, 0.0752, 0.0355, 0.0432, 0.0561),
                proportional=True,
                told=lambda f: {"amplitude_N": (f.size, 0.0), "nip_radius_m": (f.shape, 0.0)},
            ),
        ),
        line="turn",
        coordinate=beyond.turn_of_nip,
        alike="one line",
    ),
    EffectRow(
        name="loop_delay",
        change=effects.delay,
        drawn_at=("unwind", "rewind"),
        forms=(Form(first_size=0.03, largest=0.2, step=TICK_S, told=size_is("delay_s")),),
        standing=True,
    ),
    EffectRow(
        name="rate_limit",
        change=effects.ramped_correction,
        forms=(
            Form(
                name="of the correction",
                drawn_at=("unwind", "rewind"),
                first_size=10.0,
                largest=100.0,
                told=lambda f: {"slew_m_s2": (1.0 / f.size, 0.0)},
            ),
            Form(
                name="of the reference",
                change=effects.ramped_reference,
                drawn_at=tuple(DRIVES),
                first_size=10.0,
                largest=100.0,
                told=lambda f: {"slew_m_s2": (1.0 / f.size, 0.0)},
            ),
        ),
        standing=True,
    ),
    EffectRow(
        name="radius_error",
        change=effects.believed_radius,
        drawn_at=tuple(DRIVES),
        forms=(
            Form(
                first_size=1e-3,
                either_sign=True,
                largest=0.02,
                proportional=True,
                told=size_is("ratio", 1.0),
            ),
        ),
        alike="standing",
        rival_at=tuple(DRIVES),
        standing=True,
    ),
    EffectRow(
        name="encoder_eccentricity",
        change=effects.encoder,
        drawn_at=tuple(DRIVES),
        forms=(
            Form(
                first_size=2e-4, shapes=(0.0, 1.0), proportional=True, told=size_is("eccentricity")
            ),
        ),
        line="turn",
        alike="one line",
        rival_at=tuple(DRIVES),
        rival_shapes=(0.0, 1.0),
    ),
    *BEYOND,
)
BY_NAME = {row.name: row for row in EFFECTS}
LIBRARY = tuple(row for row in EFFECTS if row.outside is None)
