"""Registers the studio's page."""

from __future__ import annotations

from nicegui import Client, background_tasks, ui

from flowtree.studio.page.studio_page import StudioPage
from flowtree.studio.page.workbench import Workbench
from flowtree.studio.session import Session


def build_page(session: Session) -> None:
    """Shows a session at ``/``; every tab has its own page on the same session.

    A second tab is told that it is one: both may work, each sees what the other does.
    """

    @ui.page("/", title="flowtree studio")
    async def studio(client: Client) -> None:
        bench = Workbench(session)
        page = StudioPage(bench, client)
        await client.connected()
        if client.is_deleted:  # whoever asked did not want to see it
            return

        def join() -> None:
            if session.enter() > 0:
                page.tell("This project is open in another tab, too: both change the same.", "info")

        join()
        client.on_connect(join)
        client.on_disconnect(session.leave)
        stop = page.begin()
        work = background_tasks.create(bench.work(), name="studio page")

        def end() -> None:
            stop()
            work.cancel()

        client.on_delete(end)
