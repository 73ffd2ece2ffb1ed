"""Between processes: packets, requests, and the folder where they meet."""

__all__ = ["files", "packets", "request_client", "request_socket", "runtime_directory"]
