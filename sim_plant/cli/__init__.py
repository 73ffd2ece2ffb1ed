"""The sim-plant command."""
