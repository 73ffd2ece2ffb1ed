"""The wire: register codec and transports."""
