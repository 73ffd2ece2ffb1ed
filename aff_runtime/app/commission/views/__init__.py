"""What a screen is shown, as frozen records."""

__all__ = ["of_line", "of_refining", "of_settings", "of_weeks"]
