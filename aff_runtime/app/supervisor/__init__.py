"""The supervisor: starts and watches the other processes, answers requests."""
