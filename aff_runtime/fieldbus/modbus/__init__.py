"""Modbus: TCP, TLS and RTU."""

__all__ = [
    "codec",
    "frames",
    "gateway",
    "probe_map",
    "registers",
    "rtu_wire",
    "serial_time",
    "tcp",
    "tcp_wire",
    "tls_wire",
]
