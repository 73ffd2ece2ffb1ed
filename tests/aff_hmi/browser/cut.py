"""A TCP line that can be cut without a word, as a pulled cable is, and mended again."""

from __future__ import annotations

import contextlib
import selectors
import socket
import threading


class Cable:
    """Passes on what comes to ``port`` until it is cut; then both ends hear nothing more.

    Parameters
    ----------
    to_port : on loopback.
    """

    def __init__(self, to_port: int) -> None:
        self._to = to_port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        self._is_cut = threading.Event()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def cut(self) -> None:
        self._is_cut.set()

    def mend(self) -> None:
        self._is_cut.clear()

    def close(self) -> None:
        self._ends.set()
        self._thread.join(5.0)
        self._listener.close()

    def _run(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._listener, selectors.EVENT_READ)
            while not self._ends.is_set():
                for key, _ in selector.select(0.02):
                    if self._is_cut.wait(0.0):
                        break
                    self._pass_on(selector, key)
                if self._is_cut.is_set():
                    self._ends.wait(0.02)
            for key in list(selector.get_map().values()):
                if key.data is not None:
                    key.fileobj.close()  # type: ignore[union-attr]

    def _pass_on(self, selector: selectors.BaseSelector, key: selectors.SelectorKey) -> None:
        if key.data is None:
            near, _ = self._listener.accept()
            try:
                far = socket.create_connection(("127.0.0.1", self._to))
            except OSError:  # nobody is there just now
                near.close()
                return
            for one, other in ((near, far), (far, near)):
                selector.register(one, selectors.EVENT_READ, other)
            return
        source, target = key.fileobj, key.data
        assert isinstance(source, socket.socket)
        try:
            chunk = source.recv(1 << 16)
            if chunk:
                target.sendall(chunk)
                return
        except OSError:
            pass
        for one in (source, target):
            with contextlib.suppress(KeyError, ValueError):
                selector.unregister(one)
            one.close()
