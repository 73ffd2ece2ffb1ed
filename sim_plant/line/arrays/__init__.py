"""From a declaration to the flat arrays of the kernel, with effects and corrections on them."""

__all__ = ["build", "build_bodies", "corrections", "locations", "with_effects"]
