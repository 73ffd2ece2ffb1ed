"""Parameters and verdicts from recorded data, each with a confidence interval or a refusal."""

__all__ = ["driven_roller", "idler_friction", "record", "roller_run", "validation"]
