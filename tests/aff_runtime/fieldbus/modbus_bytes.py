"""Modbus TCP frames as bytes, packed here by hand so that they judge the code under test."""

from __future__ import annotations

import struct


def tid_of(request: bytes) -> int:
    return int.from_bytes(request[:2], "big")


def function_of(request: bytes) -> int:
    return request[7]


def written_words(request: bytes) -> list[int]:
    """Words of an FC16 or FC23 request."""
    start = 13 if function_of(request) == 16 else 17
    payload = request[start:]
    return list(struct.unpack(f">{len(payload) // 2}H", payload))


def register_reply(
    request: bytes,
    words: list[int],
    *,
    tid: int | None = None,
    protocol: int = 0,
    device_id: int | None = None,
    byte_count: int | None = None,
) -> bytes:
    """Reply to FC3 or FC23, wrong in the places that are given."""
    body = struct.pack(f">{len(words)}H", *words)
    return (
        struct.pack(
            ">HHHBBB",
            tid_of(request) if tid is None else tid,
            protocol,
            3 + len(body),
            request[6] if device_id is None else device_id,
            function_of(request),
            len(body) if byte_count is None else byte_count,
        )
        + body
    )


def write_reply(request: bytes) -> bytes:
    """Reply to FC16."""
    return request[:4] + b"\x00\x06" + request[6:12]


def exception_reply(request: bytes, code: int) -> bytes:
    return request[:4] + bytes([0, 3, request[6], request[7] | 0x80, code])
