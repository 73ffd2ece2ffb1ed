"""A run whose site calls everything otherwise than the Euclid line does."""

from pathlib import Path

import numpy as np

from sim_plant.line.reading.load import load_declaration
from sim_plant.refine.records.recording import Recording, RunFacts
from sim_plant.refine.records.run_activity import Activity
from sim_plant.refine.records.run_site import RunActuator, RunSite
from tests.lockstep.known_response import ROOT

LINE = load_declaration(ROOT / "config/lines/euclid.yaml")
STEP_S, ROWS = 0.005, 6000
TIME_S = np.arange(ROWS) * STEP_S
NO_ACTIVITY = Activity(on_s=0, off_s=30, probing_s=0, ramp_s=0, saturated_s=0, shadow_s=0)
SPEED_M_S, UNWIND_M, FOLLOWER_M = 0.9, 0.19, 0.15367
UNWIND_RAD, FOLLOWER_RAD = SPEED_M_S * TIME_S / UNWIND_M, SPEED_M_S * TIME_S / FOLLOWER_M


def actuator(suffix="m_s", reference="t_ref_N", roll=""):
    return RunActuator(
        suffix=suffix, signal="web_N", reference=reference, count=1e-5, roll=roll, transport_s=None
    )


def run(columns=None, *, actuators=None, speed_reference="", rolls=None):
    """Return a record of a site that calls everything otherwise than the line does."""
    angle = SPEED_M_S * TIME_S
    given = {
        "web_N": np.full(ROWS, 88.0),
        "t_ref_N": np.where(TIME_S < 20.0, 88.0, 92.0),
        "v_m_s": np.full(ROWS, SPEED_M_S + 0.0004),
        "turns_rad": angle / UNWIND_M,
        "follower_rad": angle / FOLLOWER_M,
        "roll_m": np.full(ROWS, UNWIND_M),
    }
    given |= columns or {}
    uses = {
        "unwind": {"angle": "turns_rad", "radius": "roll_m"},
        "swrap_follower": {"angle": "follower_rad"},
    }
    site = RunSite(
        name="L",
        speed="v_m_s",
        speed_reference=speed_reference,
        rolls=uses if rolls is None else rolls,
        actuators={"unwind": actuator()} if actuators is None else actuators,
        needed=frozenset(given),
        count_sizes=dict.fromkeys((n for n in given if not n.startswith("correction_")), 0.001),
    )
    facts = RunFacts(
        site=site, activity=NO_ACTIVITY, delivery_known={"unwind": False}, scan_s=STEP_S
    )
    return Recording(
        path=Path("RUN"),
        sha256="0",
        sample_time_s=STEP_S,
        columns={n: v for n, v in given.items() if v is not None},
        run=facts,
        zeros_rad={"turns_rad": 3.5},
    )
