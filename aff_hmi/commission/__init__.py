"""Commissioning and its card on the screen: the commissioner looked at, and asked."""

__all__ = ["link", "looks", "presses", "routes", "run_routes", "sentences", "settings_routes"]
