"""Support functions, common tangents, moment arms: pure functions."""

__all__ = [
    "convex_hull",
    "extrema",
    "lookup",
    "roll_profiles",
    "shapes",
    "source_convex",
    "source_eccentric",
    "source_ellipse",
    "source_flow",
    "table",
    "tangent",
    "wound_mass",
]
