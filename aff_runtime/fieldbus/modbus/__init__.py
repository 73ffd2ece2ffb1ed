"""Modbus: TCP, TLS and RTU."""

__all__ = [
    "codec",
    "connections",
    "frames",
    "gateway",
    "probe_map",
    "registers",
    "serial_time",
    "tcp_wire",
    "transport",
    "udp_wire",
]
