"""Between processes: packets, requests, and the folder where they meet."""

__all__ = [
    "answers",
    "messages",
    "packet_client",
    "packets",
    "parameter_record",
    "peer",
    "replies",
    "request_client",
    "request_socket",
    "requests",
    "runtime_directory",
    "settings_answer",
    "settings_request",
]
