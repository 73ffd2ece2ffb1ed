"""From measured records to what a line declaration lacks: residual, cause, amended model."""

__all__ = [
    "confirm",
    "example",
    "judge",
    "lacking",
    "model",
    "pipeline",
    "records",
    "report",
    "without_line",
]
