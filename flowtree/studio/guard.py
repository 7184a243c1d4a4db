"""Lets in nobody but the page that this server sent."""

from __future__ import annotations

from collections.abc import Mapping
from urllib.parse import urlsplit

from starlette.types import ASGIApp, Message, Receive, Scope, Send

_HOSTS = ("127.0.0.1", "localhost", "[::1]")
_HEADERS = (
    # Widgets bring styles and templates of their own; nothing comes from elsewhere, nobody frames the page.
    (
        b"content-security-policy",
        b"default-src 'self' data: blob: 'unsafe-inline' 'unsafe-eval'; frame-ancestors 'none'; "
        b"form-action 'self'; base-uri 'self'",
    ),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
_REFUSED = b"flowtree studio: only its own page on this machine may ask\n"


class Guard:
    """Refuses requests and websockets that another site, or a name that only points here, is behind.

    A site elsewhere can have its visitors' browsers send requests to this machine: those carry its Origin. A
    name of its own that it lets point to this machine is in the Host.

    Args:
        app: what is guarded.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serves one request (ASGI)."""
        if scope["type"] == "lifespan" or is_ours(scope["type"], _headers(scope), scope.get("method", "")):
            await self._app(scope, receive, _with_headers(send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        else:
            start = {"type": "http.response.start", "status": 403}
            await send({**start, "headers": [(b"content-type", b"text/plain; charset=utf-8")]})
            await send({"type": "http.response.body", "body": _REFUSED})


def is_ours(kind: str, headers: Mapping[str, str], method: str) -> bool:
    """Whether a request comes from the page itself, or from somebody at this machine who opens it.

    Args:
        kind: "http" or "websocket".
        headers: by lower-case name.
        method: of HTTP.
    """
    host = headers.get("host", "")
    name, colon, port = host.rpartition(":") if not host.endswith("]") else (host, "", "")
    if (name if colon else host) not in _HOSTS or (colon and not port.isdecimal()):
        return False
    origin = headers.get("origin")
    if origin is not None:
        parts = urlsplit(origin)
        return parts.scheme in ("http", "ws") and parts.netloc == host
    site = headers.get("sec-fetch-site", "none")
    opened = kind == "http" and method == "GET" and headers.get("sec-fetch-mode") == "navigate"
    return site in ("none", "same-origin") or opened


def _headers(scope: Scope) -> dict[str, str]:
    return {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}


def _with_headers(send: Send) -> Send:
    async def send_guarded(message: Message) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", ()), *_HEADERS]}
        await send(message)

    return send_guarded
