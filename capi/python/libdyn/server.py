"""The server of a viewer: its page over HTTP, and WebSockets (RFC 6455). See live."""

from __future__ import annotations

import base64
import hashlib
import socket
import struct
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BufferedIOBase
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .live import Viewer

_MAGIC = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # RFC 6455
_LARGEST = 65536


def frame(payload: bytes, opcode: int) -> bytes:
    """A WebSocket message of a server."""
    n = len(payload)
    size = bytes([n]) if n < 126 else b"\x7e" + struct.pack(">H", n) if n < 65536 else b"\x7f" + struct.pack(">Q", n)
    return bytes([0x80 | opcode]) + size + payload


def message(file: BufferedIOBase) -> tuple[int, bytes] | None:
    """A message of a client, in one frame as pages send them; None: it is gone, or says something else."""
    begin = file.read(2)
    if len(begin) < 2 or not begin[0] & 0x80 or not begin[1] & 0x80:
        return None
    n = begin[1] & 0x7F
    if n == 126:
        n = struct.unpack(">H", file.read(2))[0]
    if n == 127 or n > _LARGEST:
        return None
    mask = file.read(4)
    payload = file.read(n)
    if len(payload) < n:
        return None
    return begin[0] & 0x0F, bytes(b ^ mask[k % 4] for k, b in enumerate(payload))


class Handler(BaseHTTPRequestHandler):
    viewer: Viewer
    protocol_version = "HTTP/1.1"
    timeout: float | None = 30
    close_connection: bool

    def log_message(self, *_: Any) -> None:
        pass

    def do_GET(self) -> None:
        port, home = self.viewer.port, f"/{self.viewer.word}/"
        hosts = (f"127.0.0.1:{port}", f"localhost:{port}")
        upgrade = self.path == home + "ws" and self.headers.get("Upgrade", "").lower() == "websocket"
        origin = self.headers.get("Origin")
        if self.headers.get("Host") not in hosts or not (self.path == home or upgrade):
            self._reply(404, "There is nothing here: the address is the one that the viewer printed.\n", "text/plain")
        elif (origin is None and upgrade) or (origin is not None and origin not in [f"http://{host}" for host in hosts]):
            self._reply(403, "Pages of other origins are refused.\n", "text/plain")
        elif upgrade:
            self._listen()
        else:
            self._reply(200, self.viewer.text, "text/html; charset=utf-8")

    def _reply(self, status: int, text: str, kind: str) -> None:
        body = text.encode()
        self.send_response(status)
        for name, value in (("Content-Type", kind), ("Content-Length", str(len(body))), ("Cache-Control", "no-store"),
                            ("Referrer-Policy", "no-referrer"), ("X-Content-Type-Options", "nosniff"),
                            ("Content-Security-Policy", "frame-ancestors 'none'"), ("Connection", "close")):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)
        self.close_connection = True

    def _listen(self) -> None:
        key = self.headers.get("Sec-WebSocket-Key", "").encode()
        self.send_response(101)
        for name, value in (("Upgrade", "websocket"), ("Connection", "Upgrade"),
                            ("Sec-WebSocket-Accept", base64.b64encode(hashlib.sha1(key + _MAGIC).digest()).decode())):
            self.send_header(name, value)
        self.end_headers()
        self.close_connection = True
        self.connection.settimeout(None)
        # a page that reads nothing for a second is dropped: it does not hold up the simulation
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("ll", 1, 0))
        self._writing = threading.Lock()
        self.viewer._came(self)
        try:
            while (found := message(self.rfile)) is not None:
                opcode, payload = found
                if opcode == 8:
                    break
                if opcode == 9:
                    self.send(payload, 10)
                elif opcode == 1:
                    self.viewer._heard(payload)
        except (OSError, struct.error):
            pass
        finally:
            self.viewer._left(self)

    def send(self, payload: bytes, opcode: int) -> None:
        with self._writing:
            self.connection.sendall(frame(payload, opcode))


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        pass  # a page that is gone


def serve(viewer: Viewer, port: int) -> Server:
    """A server of the loopback interface in a thread of its own; port 0: any free one."""
    server = Server(("127.0.0.1", port), type("Handler", (Handler,), {"viewer": viewer}))
    threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.1}, daemon=True).start()
    return server
