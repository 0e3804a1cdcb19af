"""The explorer's page on this machine's loopback, by the standard library alone.

Only four addresses exist, all answered from memory; requests under another name of this machine or from
another origin are refused, so that no page elsewhere can ask through somebody's browser.
"""

import json
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Lock
from typing import Any

from regrasp.errors import InvalidInput
from regrasp.explore.dialogue import reply
from regrasp.explore.start import Start
from regrasp.web.modules import module, style

HOST = "127.0.0.1"
MOST_BYTES = 65536
"""Of a question."""
_IDLE = 30.0  # seconds that a connection may be silent
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>regrasp explore</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="/look.css">
</head>
<body>
<main id="explorer"></main>
<script type="module" src="/explore.js"></script>
</body>
</html>
"""
_START = """
const explorer = document.getElementById("explorer");
const begin = await (await fetch("/start")).json();
open_explorer(explorer, begin, async (asked) => {
  const sent = {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(asked)};
  return await (await fetch("/answer", sent)).json();
});
"""
MODULES = ("scene", "charts", "turning", "handles", "plane", "solid", "loop", "placement", "explore")


class Server(ThreadingHTTPServer):
    """Serves one page, its module, its style and its answers; close it after use.

    Args:
        start: what the page begins with.
        port: 0 for any that is free.

    Raises:
        InvalidInput: Where the port cannot be had.
    """

    daemon_threads = True
    allow_reuse_address = True

    def __init__(self, start: Start, port: int = 0) -> None:
        self.start = start
        self.thinking = Lock()  # one question at a time: dragging asks faster than solvers answer
        try:
            super().__init__((HOST, port), _Handler)
        except (OSError, OverflowError) as error:
            raise InvalidInput(f"port {port} cannot be had: {error}; leave --port out") from None

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self.server_address[1])

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{HOST}:{self.port}/"

    @property
    def names(self) -> set[str]:
        """What a request may call this machine."""
        return {f"{name}:{self.port}" for name in (HOST, "localhost")}

    def handle_error(self, *_: Any) -> None:
        """A browser that hangs up is nobody's error."""


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "regrasp", ""
    disable_nagle_algorithm = True
    wbufsize = -1  # one packet an answer
    timeout = _IDLE

    def do_GET(self) -> None:
        """The page, its module, its style, its start."""
        if not self._welcome():
            return
        if self.path == "/":
            self._send(_PAGE, "text/html")
        elif self.path == "/explore.js":
            self._send(module(*MODULES) + _START, "text/javascript")
        elif self.path == "/look.css":
            self._send(style(), "text/css")
        elif self.path == "/start":
            with self.server.thinking:
                self._json(self.server.start.to_dict())
        else:
            self._refuse(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """The answer to a question."""
        if not self._welcome():
            return None
        if self.path != "/answer":
            return self._refuse(HTTPStatus.NOT_FOUND)
        if self.headers.get_content_type() != "application/json":
            return self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE)
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit() and len(length) < 9):
            return self._refuse(HTTPStatus.LENGTH_REQUIRED)
        if int(length) > MOST_BYTES:
            return self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
        try:
            asked = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            return self._refuse(HTTPStatus.BAD_REQUEST)
        with self.server.thinking:
            answered = reply(self.server.start, asked)
        return self._json(answered)

    def _welcome(self) -> bool:
        """Whether the request names this server and comes from its own page, or from none."""
        hosts, origins = self.headers.get_all("Host", []), self.headers.get_all("Origin", [])
        names = self.server.names
        if (
            len(hosts) == 1
            and hosts[0] in names
            and all(o in {f"http://{n}" for n in names} for o in origins)
        ):
            return True
        self._refuse(HTTPStatus.FORBIDDEN)
        return False

    def _refuse(self, status: HTTPStatus) -> None:
        self.close_connection = True  # what was sent besides is not read
        self._send(f"{status.phrase}\n", "text/plain", status)

    def _json(self, value: dict[str, Any]) -> None:
        self._send(json.dumps(value, allow_nan=False), "application/json")

    def _send(self, text: str, kind: str, status: HTTPStatus = HTTPStatus.OK) -> None:
        body = text.encode()
        self.send_response(status)
        for name, value in (
            ("Content-Type", f"{kind}; charset=utf-8"),
            ("Content-Length", str(len(body))),
            ("Content-Security-Policy", _POLICY),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("Cache-Control", "no-store"),
            *((("Connection", "close"),) if self.close_connection else ()),
        ):
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: Any) -> None:
        """Nothing is logged."""
