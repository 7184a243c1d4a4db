"""The studio's server, as its own process: what it serves, what it refuses, how it ends."""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request

from flowtree.errors import InputError
from flowtree.studio.layer_shelf import ShownLayer
from flowtree.studio.run_studio import choose_port
from flowtree.studio.serve import add_routes
from tests.pictures import save_pair

_ROUTES = [
    ("GET", "/state"),
    ("POST", "/photo?name=a.png"),
    ("GET", "/_nicegui_ws/socket.io/?EIO=4&transport=polling"),
]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served")
    command = [Path(sys.executable).parent / "flowtree", "studio", folder / "oak", "--no-browser"]
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    # NiceGUI behaves otherwise where it finds itself in a test.
    outside = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    started = subprocess.Popen(
        [*command, "--port", str(port)], stdout=subprocess.PIPE, text=True, env=outside
    )
    try:
        assert f"http://127.0.0.1:{port}" in started.stdout.readline()
        for _ in range(200):
            with socket.socket() as probe:
                probe.settimeout(0.1)
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            assert started.poll() is None
            time.sleep(0.1)
        yield port, folder
    finally:
        started.send_signal(signal.SIGTERM)  # the browser's tests send Ctrl-C
        out, _ = started.communicate(timeout=30)
    assert started.returncode == 0
    assert "saved" in out


def _ask(port, method, path, body=None, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    try:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, body, named)
        answer = connection.getresponse()
        return answer.status, answer.read(), dict(answer.getheaders())
    finally:
        connection.close()


def test_the_page_and_the_state_are_served_to_this_machine(server):
    port, _ = server
    status, page, headers = _ask(port, "GET", "/")
    assert status == 200
    assert b"flowtree studio" in page
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    addresses = set(re.findall(rb"https?://[\w.-]+", page)) - {b"http://www.w3.org", b"https://www.w3.org"}
    assert not {address for address in addresses if b"127.0.0.1" not in address}
    status, state, _ = _ask(port, "GET", "/state")
    assert json.loads(state)["photos"] == []
    with open("/proc/net/tcp" if Path("/proc/net/tcp").exists() else os.devnull) as listening:
        own = [line.split()[1] for line in listening if f":{port:04X} 00000000:0000 0A" in line]
    assert not own or own == [f"0100007F:{port:04X}"]


@pytest.mark.parametrize(("method", "path"), _ROUTES)
def test_nobody_else_is_let_in(server, method, path):
    port, _ = server
    assert _ask(port, method, path, b"", Origin="http://evil.example")[0] == 403
    assert _ask(port, method, path, b"", Host="evil.example")[0] == 403


def test_a_strange_websocket_is_refused(server):
    port, _ = server
    status, _, _ = _ask(
        port,
        "GET",
        "/_nicegui_ws/socket.io/?EIO=4&transport=websocket",
        Origin="http://evil.example",
        Connection="Upgrade",
        Upgrade="websocket",
        Sec_WebSocket_Version="13",
        Sec_WebSocket_Key="dGhlIHNhbXBsZSBub25jZQ==",
    )
    assert status == 403


def test_photos_are_taken_and_wrong_ones_refused_in_one_line(server, tmp_path):
    port, folder = server
    front, _ = save_pair(tmp_path)
    status, answer, _ = _ask(port, "POST", "/photo?name=../../front.png", front.read_bytes())
    assert (status, json.loads(answer)) == (200, {"photo": 0})
    assert [file.name for file in (folder / "oak" / "photos").glob("*/*")] == ["front.png"]
    status, answer, _ = _ask(port, "POST", "/photo?name=a.png", b"no picture")
    assert status == 422
    assert "must be a whole JPEG" in json.loads(answer)["message"]
    status, answer, _ = _ask(port, "POST", "/picture/flow.step?name=a.png", front.read_bytes())
    assert "must be one of" in json.loads(answer)["message"]
    status, answer, _ = _ask(port, "POST", "/open", b"PK no zip")
    assert "must be a zip file" in json.loads(answer)["message"]


def test_what_is_too_large_is_refused_before_it_comes(server):
    port, _ = server
    assert _ask(port, "POST", "/photo?name=a.png", Content_Length=str(10**9))[0] == 413


@pytest.mark.parametrize(
    "path",
    ["/layer/1/nothing", "/layer/1/..%2f..%2fetc%2fpasswd", "/export/..%2foak", "/layer/x/photo/0", "/files"],
)
def test_no_path_of_a_client_is_read(server, path):
    assert _ask(server[0], "GET", path)[0] == 404


def test_a_port_in_use_is_one_clear_line(server):
    with pytest.raises(InputError, match="must be free"):
        choose_port(server[0])
    with pytest.raises(InputError, match="1 to 65535"):
        choose_port(99999)
    assert choose_port(None) != server[0]


def test_a_box_is_served_only_with_the_matte_it_belongs_to():
    class Session:
        def layer(self, name):
            return ShownLayer(7, "image/png", b"box") if name == "matte-part/0" else None

    app = Starlette()
    add_routes(app, Session())
    endpoint = next(route.endpoint for route in app.routes if route.path.startswith("/layer"))

    def ask(revision, name):
        return endpoint(Request({"type": "http", "path_params": {"revision": revision, "name": name}}))

    assert ask(7, "matte-part/0").body == b"box"
    assert ask(6, "matte-part/0").status_code == 204, "no error: the page asks for the whole"
    with pytest.raises(HTTPException):
        ask(7, "matte-part/1")
