"""Modbus: TCP, TLS and RTU."""
