"""From measured records to what a line declaration lacks: residual, cause, amended model."""

__all__ = ["example", "judge", "lacking", "model", "pipeline", "records", "report", "without_line"]
