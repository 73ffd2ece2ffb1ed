"""The screen's wizard played on unusual plants: words, probe, ACTIVE, card signed and printed."""
