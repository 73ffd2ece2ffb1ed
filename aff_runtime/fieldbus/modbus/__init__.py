"""Modbus: TCP, TLS and RTU."""

__all__ = [
    "byte_stream",
    "codec",
    "connections",
    "frames",
    "gateway",
    "probe_map",
    "registers",
    "serial_time",
    "transport",
    "udp_wire",
]
