"""The web: its way over the bodies, and its unstretched length in every span.

Every span holds an unstretched length M. What passes the touching points changes it: dM = dS_in /
(1 + strain before) - dS_out / (1 + strain), with dS the arc or the edges that went by; strain is
L / M - 1. A seam is followed by the unstretched web that each body has passed since it came.
"""

from __future__ import annotations

import math

from benchmarks.campaign.contact import span_between
from benchmarks.campaign.jit import compiled
from benchmarks.campaign.state import (
    CREEP,
    CREEP_S,
    DRAG,
    FREE,
    NOT_YET,
    SLIP,
    STIFFENING,
    WAVE,
    WAVE_M,
    Machine,
    State,
)

EDGE_M = 0.01
"""Length of web over which a seam lifts it."""


@compiled
def level(time_s: float, from_s: float, rise_s: float, until_s: float) -> float:
    """Return how much of a change is there (0..1): up from a moment on, down from another."""
    rise = max(rise_s, 1e-9)
    up = min(max((time_s - from_s) / rise, 0.0), 1.0)
    down = min(max((time_s - until_s) / rise, 0.0), 1.0)
    return up - down


@compiled
def follow_changes(m: Machine, s: State, time_s: float) -> None:
    """Write what has changed at this time of the record."""
    for e in range(m.change.shape[0]):
        k = int(m.change[e, 1])
        now = m.change[e, 2] * level(time_s, m.change[e, 3], m.change[e, 4], m.change[e, 5])
        if m.change[e, 0] == DRAG:
            s.more_drag[k] = now
        elif m.change[e, 0] == FREE:
            s.more_free[k] = now
        elif m.change[e, 0] == SLIP:
            s.more_slip[k] = now


@compiled
def wrap_m(m: Machine, s: State, k: int) -> float:
    """Return the length of web on a body; none on a roll."""
    if k == 0 or k == s.theta.size - 1:
        return 0.0
    turn = m.bodies.sense[k] * (s.phi[k] - s.phi[k - 1])
    return float(s.radius[k] * (turn - 2.0 * math.pi * math.floor(turn / (2.0 * math.pi))))


@compiled
def smooth(x: float) -> float:
    """Return a step of half a cosine from 0 to 1."""
    return 0.5 - 0.5 * math.cos(math.pi * min(max(x, 0.0), 1.0))


@compiled
def lift_web(m: Machine, s: State) -> None:
    """Write how much further out the web runs where a seam lies on a body."""
    for k in range(1, s.theta.size - 1):
        s.lift[k] = 0.0
        if s.behind[k] < 0.0:
            continue
        gone = s.behind[k] * (1.0 + s.leaves[k - 1])
        off = wrap_m(m, s, k) + m.seam[4]
        if gone < off + EDGE_M:
            s.lift[k] = m.seam[3] * (smooth(gone / EDGE_M) - smooth((gone - off) / EDGE_M))


@compiled
def lengths(m: Machine, s: State, time_s: float) -> None:
    """Write length, edges passed and lever arms of all spans to ``s.geometry``."""
    last = s.theta.size - 1
    per_turn = m.web[2] / (2.0 * math.pi)
    for k in (0, last):
        change = per_turn * (s.theta[k] - s.zero[k]) * (1.0 if k == last else -1.0)
        change += s.thicker[0 if k == 0 else 1]
        s.radius[k] = m.radius[k] + change
        s.out_m[k] = change
    if m.seam[3] != 0.0:
        lift_web(m, s)
    for k in range(last + 1):
        s.reach[k] = s.radius[k] + s.lift[k]
    for i in range(last):
        span_between(m.bodies, i, s.reach, s.out_m, s.theta, s.phi, s.vertices, s.geometry[i])
    s.geometry[0, 0] -= s.axle[0]
    for k in range(m.shake.shape[0]):
        at = time_s if m.shake[k, 1] == 0.0 else s.passed[0]
        turn = 2.0 * math.pi * m.shake[k, 2] * at + m.shake[k, 4]
        s.geometry[int(m.shake[k, 0]), 0] += m.shake[k, 3] * math.cos(turn)


@compiled
def grow_rolls(m: Machine, s: State) -> None:
    """Let the rolls take and give web of the thickness behind a seam."""
    per_turn = m.web[2] / (2.0 * math.pi) * (m.seam[2] - 1.0)
    last = s.theta.size - 1
    if s.behind[0] >= 0.0:
        s.thicker[0] -= per_turn * s.turn[0]
    if s.behind[last] >= 0.0:
        s.thicker[1] += per_turn * s.turn[last]


@compiled
def share_of(m: Machine, k: int, slip: float, speed: float) -> float:
    """Return how much of its surface speed body ``k`` gives to the web."""
    beyond = speed - m.slip_speed[k]
    if slip == 0.0 or beyond <= 0.0:
        return 1.0
    return float(1.0 - slip * beyond)


@compiled
def fed_by(m: Machine, s: State, k: int, i: int, edges_m: float, step_s: float) -> float:
    """Return the length of web that body ``k`` passes at span ``i`` in this step."""
    length = edges_m
    if m.bodies.polygon[k] < 0:
        length = s.reach[k] * (s.turn[k] - m.bodies.sense[k] * s.swing[i])
    slip = m.slip[k] + s.more_slip[k]
    if slip == 0.0:
        return length
    return length * share_of(m, k, slip, s.radius[k] * s.turn[k] / step_s)


@compiled
def new_share(m: Machine, s: State, i: int, passed_m: float) -> float:
    """Return the share (0..1) of new web in span ``i``; ``passed_m`` left its body in this step.

    New web has left the wrap of the body before the span; where it fills the span its first end
    comes to the next body.
    """
    if s.behind[i] < 0.0:
        return 0.0
    if i == 0:
        s.behind[0] += passed_m
    before = s.leaves[i - 1] if i > 0 else s.leaves[0]
    new = s.behind[i] - wrap_m(m, s, i) / (1.0 + before)
    if s.behind[i + 1] < 0.0 and new >= s.held[i]:
        s.behind[i + 1] = new - s.held[i]
    return float(min(max(new / s.held[i], 0.0), 1.0))


@compiled
def strain_into(m: Machine, s: State, i: int) -> float:
    """Return the strain of the web that body ``i`` gives to the span after it."""
    if i == 0:
        return float(m.web[4] / (m.seam[1] if s.behind[0] >= 0.0 else 1.0))
    if s.behind[i] >= 0.0:
        off = s.behind[i] * (1.0 + s.leaves[i - 1]) < wrap_m(m, s, i)
        if off:  # the end of the old web is still on the body
            return float(s.old[i - 1])
    return float(s.leaves[i - 1])


@compiled
def creep(m: Machine, s: State, i: int, gained_m: float, step_s: float) -> float:
    """Return the tension of the branch that creeps in span ``i``, as a share of its stiffness.

    The strain that has crept goes with the web: V = M v, dV = v_before dM_in - v dM_out + M b/tau,
    with b = strain - v the elastic strain of the branch; ``gained_m`` is what passed the ends.
    """
    fresh = s.geometry[i, 0] / s.held[i] - 1.0
    s.crept[i] += gained_m
    s.crept[i] += (fresh * s.held[i] - s.crept[i]) * step_s / m.web[CREEP_S]
    return float(m.web[CREEP] * (fresh - s.crept[i] / s.held[i]))


@compiled
def stretch(m: Machine, s: State, step_s: float) -> None:
    """Move web through all spans and write strains and tensions."""
    inside = 0.0
    spliced = s.behind[0] != NOT_YET
    before, crept_before = strain_into(m, s, 0), m.web[4]  # web on the roll has crept all the way
    for i in range(s.held.size):
        fed = fed_by(m, s, i, i, s.geometry[i, 1], step_s) / (1.0 + before)
        taken = fed_by(m, s, i + 1, i, s.geometry[i, 2], step_s) / (1.0 + s.leaves[i])
        crept = s.crept[i] / s.held[i]
        gained, crept_before = crept_before * fed - crept * taken, crept
        before = s.leaves[i]
        if i == 0:
            s.passed[1] += fed
        if spliced:
            before = strain_into(m, s, i + 1)
            if s.behind[i + 1] >= 0.0:
                s.behind[i + 1] += taken
        s.held[i] += fed - taken
        inside += s.held[i]
        fresh = s.geometry[i, 0] / s.held[i] - 1.0
        rate = (fresh - s.strain[i]) / step_s
        stiff = m.modulus[i]
        new = new_share(m, s, i, fed) if spliced else 0.0
        if new > 0.0:  # two springs in a row
            stiff /= 1.0 - new + new / m.seam[1]
        if m.web[WAVE] != 0.0:  # compliance wave of the web, averaged over the span
            half = math.pi * s.held[i] / m.web[WAVE_M]
            middle = 2.0 * math.pi * (s.passed[1] - inside + 0.5 * s.held[i]) / m.web[WAVE_M]
            stiff /= 1.0 + m.web[WAVE] * math.sin(half) / half * math.cos(middle)
        free = m.free[i] + s.more_free[i]
        tension = stiff * (fresh - free)
        if m.web[STIFFENING] != 0.0:
            tension *= 1.0 + m.web[STIFFENING] * (tension / 90.0 - 1.0)
        if m.web[CREEP] != 0.0:
            tension += stiff * creep(m, s, i, gained, step_s)
        s.pull[i] = max(0.0, tension + m.modulus[i] * m.web[0] * rate)
        s.strain[i] = s.leaves[i] = s.old[i] = fresh
        if new > 0.0:
            s.old[i] = free + (fresh - free) * stiff / m.modulus[i]
            s.leaves[i] = free + (s.old[i] - free) / (m.seam[1] if new == 1.0 else 1.0)
