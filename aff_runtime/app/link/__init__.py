"""Between processes: packets, requests, and the folder where they meet."""

__all__ = [
    "files",
    "messages",
    "packets",
    "peer",
    "request_client",
    "request_socket",
    "requests",
    "runtime_directory",
]
