"""The studio's own addresses, beside those of the page."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, Response

from flowtree.errors import FlowtreeError
from flowtree.studio.guard import Guard
from flowtree.studio.keep_picture import LARGEST
from flowtree.studio.session import Session

_ARCHIVE = 400_000_000  # bytes
_FOREVER = "private, max-age=31536000, immutable"


def add_routes(app: Starlette, session: Session) -> None:
    """Adds ``/layer``, ``/photo``, ``/picture``, ``/open``, ``/export``, ``/state``, and the guard.

    No address names a path: layers and exports are looked up among those that the session has.

    Args:
        app: NiceGUI's.
        session: what is served.
    """

    def layer(request: Request) -> Response:
        found = session.layer(request.path_params["name"])
        if found is None:
            raise HTTPException(404)
        current = found.revision == int(request.path_params["revision"])
        if not current and "-part/" in request.path_params["name"]:
            return Response(status_code=204)  # the box that is known does not belong to it
        kept = {"cache-control": _FOREVER if current else "no-store"}
        return Response(found.data, media_type=found.media_type, headers=kept)

    def export(request: Request) -> Response:
        found = session.exported(request.path_params["id"])
        if found is None:
            raise HTTPException(404)
        name, data = found
        headers = {
            "content-disposition": f"attachment; filename*=UTF-8''{quote(name)}",
            "cache-control": "no-store",
        }
        return Response(data, media_type="application/octet-stream", headers=headers)

    def state(request: Request) -> Response:
        del request
        return JSONResponse(session.state_json(), headers={"cache-control": "no-store"})

    async def photo(request: Request) -> Response:
        data, name = await _body(request, LARGEST), request.query_params.get("name", "")
        return await _answer(lambda: {"photo": session.add_photo(name, data)})

    async def picture(request: Request) -> Response:
        data, name = await _body(request, LARGEST), request.query_params.get("name", "")
        return await _answer(partial(session.add_picture, request.path_params["parameter"], name, data))

    async def archive(request: Request) -> Response:
        data = await _body(request, _ARCHIVE)
        return await _answer(partial(session.open_archive, data))

    app.add_route("/layer/{revision:int}/{name:path}", layer)
    app.add_route("/export/{id}", export)
    app.add_route("/state", state)
    app.add_route("/photo", photo, methods=["POST"])
    app.add_route("/picture/{parameter}", picture, methods=["POST"])
    app.add_route("/open", archive, methods=["POST"])
    app.add_middleware(Guard)


async def _body(request: Request, most: int) -> bytes:
    """The request's body; one that is too large is refused before it has all come."""
    told = request.headers.get("content-length", "0")
    if not told.isdecimal() or int(told) > most:
        raise HTTPException(413, "too large")
    parts, size = [], 0
    try:
        async for part in request.stream():
            size += len(part)
            if size > most:
                raise HTTPException(413, "too large")
            parts.append(part)
    except ClientDisconnect:
        raise HTTPException(400, "cut off") from None
    return b"".join(parts)


async def _answer(work: Callable[[], Any]) -> Response:
    """Does something in a thread; an error of the input is answered in its words."""
    try:
        made = await run_in_threadpool(work)
    except FlowtreeError as error:
        return JSONResponse({"message": str(error)}, status_code=422)
    return JSONResponse(made if isinstance(made, dict) else {})
