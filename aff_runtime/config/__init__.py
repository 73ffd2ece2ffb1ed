"""Site files: strict YAML, pydantic models, check."""
