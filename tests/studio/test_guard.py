"""Who may ask the studio's server."""

from __future__ import annotations

import asyncio

import pytest

from flowtree.studio.guard import Guard, is_ours

_HOST = "127.0.0.1:8571"


@pytest.mark.parametrize(
    ("kind", "method", "headers", "let_in"),
    [
        ("http", "GET", {"host": _HOST}, True),
        ("http", "GET", {"host": "localhost:8571"}, True),
        ("http", "GET", {"host": "[::1]:8571"}, True),
        ("http", "GET", {"host": "127.0.0.1"}, True),
        ("http", "GET", {}, False),
        ("http", "GET", {"host": "evil.example:8571"}, False),
        ("http", "GET", {"host": "127.0.0.1.evil.example"}, False),
        ("http", "GET", {"host": "127.0.0.1:8571:x"}, False),
        ("http", "GET", {"host": "127.0.0.1:evil"}, False),
        ("http", "POST", {"host": _HOST, "origin": f"http://{_HOST}"}, True),
        ("http", "POST", {"host": _HOST, "origin": "http://evil.example"}, False),
        ("http", "POST", {"host": _HOST, "origin": "null"}, False),
        ("http", "POST", {"host": _HOST, "origin": "http://127.0.0.1:3000"}, False),
        ("http", "POST", {"host": _HOST, "origin": "http://localhost:8571"}, False),
        ("websocket", "", {"host": _HOST, "origin": f"http://{_HOST}"}, True),
        ("websocket", "", {"host": _HOST, "origin": "https://evil.example"}, False),
        ("http", "GET", {"host": _HOST, "sec-fetch-site": "same-origin"}, True),
        ("http", "GET", {"host": _HOST, "sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"}, False),
        ("http", "GET", {"host": _HOST, "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}, True),
        (
            "http",
            "POST",
            {"host": _HOST, "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"},
            False,
        ),
    ],
)
def test_only_the_page_itself_is_let_in(kind, method, headers, let_in):
    assert is_ours(kind, headers, method) is let_in
    reached, sent = _ask(kind, method, headers)
    assert reached is let_in
    if kind == "http":
        [start, _] = sent
        assert start["status"] == (200 if let_in else 403)
        if let_in:
            assert b"frame-ancestors 'none'" in dict(start["headers"])[b"content-security-policy"]
    elif not let_in:
        assert sent == [{"type": "websocket.close", "code": 1008}]


def _ask(kind, method, headers):
    reached, sent = [], []

    async def app(scope, receive, send):
        reached.append(scope)
        if kind == "http":
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": b""})

    async def receive():
        return {"type": "websocket.connect"}

    async def send(message):
        sent.append(message)

    raw = [(name.encode(), value.encode()) for name, value in headers.items()]
    scope = {"type": kind, "headers": raw, "method": method}
    asyncio.run(Guard(app)(scope, receive, send))
    return bool(reached), sent
