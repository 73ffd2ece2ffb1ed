"""What `setup` is answered about the Euclid line's bounds and sizes, on every wire alike."""

MACHINE_ANSWERS = {
    "tension_max": "400 N",
    "radius_min": "4 in",
    "radius_max": "12 in",
    "limit": "0.15",
    "second_radius": "0.15367",
    "limit_second": "40 mm/s",
}
