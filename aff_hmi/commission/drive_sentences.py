"""What check and probe say of drives, as patterns of the reader's language."""

from __future__ import annotations

from aff_hmi.words import N_

DRIVES = (
    N_("{actuator}: drive as declared"),
    N_("{actuator}: drive identified {time} at {radius} m (site file {hash}): {what}"),
    N_(
        "{actuator}: drive identified {time} at {radius} m (site file {hash}): {what}; declared: "
        "{words}"
    ),
    N_("{actuator}: plain blocks stand in: {why}"),
    N_("{actuator}: not known, its response is not read"),
    N_("speed gain {value} rad/s"),
    N_("integral time {value} s"),
    N_("integral time not shown by this probe, between {low} and {high} s"),
    N_("inertia with web {value} kg m2"),
    N_("friction {value} N m s"),
    N_("friction not shown by this probe, between {low} and {high} N m s"),
    N_("web {value} N/m"),
    N_("web not shown by this probe, between {low} and {high} N/m"),
    N_("{value} s to the drive"),
    N_("not shown by this probe, between {low} and {high} s to the drive"),
)
WHY_NONE = (
    N_("no drive is declared whole, and no probe has identified one"),
    N_("the probe of {time} identified no drive: {why}"),
    N_("the file of the response does not say why; probe again"),
    N_("a probe identified {roll}, the drive turns {other}"),
    N_("no tension is known; name error.reference or drive.tension_N"),
    N_(
        "{setting} is not shown: its 95 % interval {low} to {high} is not all above 0; raise "
        "probe.duration_s, or probe.amplitude_m_s (probe.bound_m_s where it is chosen), or "
        "declare it"
    ),
    N_(
        "{setting} is not sure enough: the 95 % interval {low} to {high} spans a factor of "
        "{factor}, {most} is the most; raise probe.duration_s, or probe.amplitude_m_s "
        "(probe.bound_m_s where it is chosen), or declare it"
    ),
    N_(
        "the declared web and motor have {declared} kg m2 at {radius} m, all that turns was found "
        "to have {found}; mend web_density_kg_m3, web_width_m or core_radius_m"
    ),
    N_(
        "{both} of {all} tones below {high} Hz are {sigmas} standard errors above the noise in "
        "speed and tension, {least} are needed (in the roll's speed {heard}, in the tension "
        "{other}): raise probe.amplitude_m_s, or probe.bound_m_s where it is chosen, or "
        "probe.duration_s"
    ),
    N_(
        "{all} tones were sent below {high} Hz, {least} are needed, and no louder ones help: name "
        "{more} more frequencies or more below {limit} Hz, away from orders, under "
        "probe.extra_frequencies_Hz, or probe at a lower line speed"
    ),
    N_(
        "no simple web path explains what was heard (misfit {misfit}, at most {most}): is "
        "line.speed that of the driven roller that ends this zone, and the tension this zone's? "
        "If so, probe again at a steady speed, or declare the drive"
    ),
    N_(
        "the tension rises when the roll turns faster: this is known for a roll that the web "
        "leaves; on one that winds up, or with a wrong sign, declare the drive"
    ),
    N_(
        "the correction acts on the roll as a torque, not as a speed: it goes in behind the speed "
        "loop; wire it to the speed reference, behind the ramp"
    ),
    N_(
        "the tones stand too close to tell their noise: beside {high} Hz from {count} places, "
        "{least} are needed; raise probe.duration_s"
    ),
    N_("the tones do not suffice for a fit; raise probe.duration_s"),
    N_("{measured} is no tension: without a force no inertia is known"),
    N_(
        "{roll} has no radius channel: on a roller the web pulls on both sides, and one tension "
        "does not tell its inertia; declare the drive"
    ),
    N_(
        "{roll} has no angle and no speed channel: what it does with a correction is not seen, so "
        "neither its speed loop nor its inertia is known; give it one, or declare the drive"
    ),
    N_(
        "the angle of {roll} was lost in {share} of the readings, {most} may be; look at its "
        "encoder, then probe again"
    ),
    N_("{radius} was no radius above 0 m; look at that channel, then probe again"),
    N_(
        "line speed or angle was missing in {count} of {all} readings, none may be; look at those "
        "channels, then probe again"
    ),
)
