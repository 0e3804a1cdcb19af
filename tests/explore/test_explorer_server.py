"""The explorer's server answers its own page only, from memory, in bounds."""

import http.client
import json
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from regrasp.errors import InvalidInput
from regrasp.explore.server import MOST_BYTES, Server
from regrasp.explore.start import start_of

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with Server(start_of()) as found:
        thread = threading.Thread(target=found.serve_forever)
        thread.start()
        yield found
        found.shutdown()
        thread.join()


def asked(server: Server, method: str, path: str, body: Any = None, **headers: str) -> tuple[int, str]:
    """Status and text; headers by their names with underscores, ``Host`` the server's own unless given."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
    try:
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        given = {"Host": f"127.0.0.1:{server.port}"} | {k.replace("_", "-"): v for k, v in headers.items()}
        if body is not None:
            given = {"Content-Type": "application/json", "Content-Length": str(len(body))} | given
        for name, value in given.items():
            connection.putheader(name, value)
        connection.endheaders()
        if body is not None:
            connection.send(body.encode())
        response = connection.getresponse()
        return response.status, response.read().decode()
    finally:
        connection.close()


def question() -> dict[str, Any]:
    return {"question": start_of().question.to_dict()}


def test_it_listens_on_the_loopback_only(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"
    with pytest.raises(InvalidInput, match="cannot be had"):
        Server(server.start, 99999)


@pytest.mark.parametrize("path", ["/", "/explore.js", "/look.css", "/start"])
def test_what_the_page_needs(server: Server, path: str) -> None:
    status, text = asked(server, "GET", path)
    assert status == 200
    assert len(text) > 100
    assert "http://" not in text.replace("http://www.w3.org/", ""), "nothing comes from elsewhere"


@pytest.mark.parametrize(
    "path",
    ["/explore.html", "/../pyproject.toml", "/%2e%2e/etc/passwd", "//etc/passwd", "/web/look.css", "/start/",
     "/look.css?x", "/answer"],
)  # fmt: skip
def test_nothing_is_served_by_name(server: Server, path: str) -> None:
    assert asked(server, "GET", path) == (404, "Not Found\n")


def test_a_question_is_answered(server: Server) -> None:
    status, text = asked(server, "POST", "/answer", json.dumps(question()))
    assert status == 200
    assert json.loads(text)["holds"]
    own = f"http://localhost:{server.port}"
    assert asked(server, "GET", "/", Origin=own, Host=own[7:])[0] == 200


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "127.0.0.1"},
        {"Host": "127.0.0.1:1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "https://127.0.0.1:{port}"},
    ],
)
def test_other_hosts_and_origins_are_refused(server: Server, method: str, headers: dict[str, str]) -> None:
    headers = {k: v.format(port=server.port) for k, v in headers.items()}
    body = json.dumps(question()) if method == "POST" else None
    assert asked(server, method, "/answer" if body else "/", body, **headers)[0] == 403


def test_questions_are_bounded(server: Server) -> None:
    text = json.dumps(question())
    fits = text + " " * (MOST_BYTES - len(text))
    assert asked(server, "POST", "/answer", fits)[0] == 200
    assert asked(server, "POST", "/answer", "", Content_Length=str(MOST_BYTES + 1))[0] == 413
    assert asked(server, "POST", "/answer", "", Content_Length="-1")[0] == 411
    assert asked(server, "POST", "/answer", text, Content_Type="text/plain")[0] == 415
    assert asked(server, "POST", "/answer", "[" * 60000)[0] == 400
    assert asked(server, "POST", "/answer", "\x00")[0] == 400
    assert asked(server, "PUT", "/answer", text)[0] == 501


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"load": [0, float("nan"), 0]}, "load must be numbers"),
        ({"load": [0, 1e300, 0]}, "load must be numbers up to 1e"),
        ({"load": "0"}, "load must be three numbers, in space six"),
        ({"load": [0, 0, 0, 0, 0, 0]}, "position must be 3 numbers"),
        ({"contacts": []}, "contacts must be a list of 2 to 6"),
        ({"contacts": [{"name": "a\nb"}] * 2}, "a name must be"),
        ({"leaves": "P9"}, "leaves must be one of P1, P2, P3"),
        ({"objective": "wrench"}, "objective must be one of"),
        ({"duration": 0}, "duration must lie between"),
        ({"squeeze": True}, "squeeze must be numbers"),
        ({"path": "/etc/passwd"}, "a question must have keys"),
    ],
)
def test_what_is_wrong_is_said(server: Server, change: dict[str, Any], words: str) -> None:
    body = json.dumps({"question": question()["question"] | change})
    status, text = asked(server, "POST", "/answer", body)
    answer = json.loads(text)
    assert status == 200
    assert not answer["holds"]
    assert answer["says"].startswith(words)
    assert "\n" not in answer["says"]


@pytest.mark.parametrize(
    ("look", "words"),
    [
        ("everything", "look must be one of tolerances"),
        (["map"], "look must be one of"),
        ("map", "needs an outline"),
    ],
)
def test_looks_are_those_known(server: Server, look: Any, words: str) -> None:
    answer = json.loads(asked(server, "POST", "/answer", json.dumps(question() | {"look": look}))[1])
    assert answer["says"].startswith(words)
