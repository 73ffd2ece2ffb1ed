"""From measured records to what a line declaration lacks: residual, cause, amended model."""
