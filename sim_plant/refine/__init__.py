"""From measured records to what a line declaration lacks: residual, cause, amended model."""

__all__ = ["example", "pipeline", "report", "without_line"]
