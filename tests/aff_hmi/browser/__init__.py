"""The screen in a real Chromium, with plant and service as real processes: ``make test-hmi``."""
