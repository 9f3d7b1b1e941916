"""The server: it listens at 127.0.0.1 alone, and ends with the terminal that it was started from.

Requests are read by one thread, which waits for no client, and answered by another, one at a time: a slow client takes a place of `MOST_READ` and
nothing else. Where all are taken, the request that is longest on its way gives up its own.
"""

from __future__ import annotations

import asyncio
import os
import queue
import secrets
import sys
import threading
from collections.abc import Callable
from typing import Any

from .controls import Board
from .http import MOST_HEAD, Refused, Response, read, refusal, write
from .routes import Site, admit, respond

#: Connections at a time whose request is still read, and requests that wait for an answer.
MOST_READ, MOST_WAITING = 64, 16
#: Seconds between two looks at the parent process.
LOOK = 1.0


class Solver:
    """A thread that answers one request at a time, and ends with the process whatever it is at."""

    def __init__(self) -> None:
        self.work: queue.SimpleQueue[tuple[asyncio.Future[Response], Callable[[], Response]]] = queue.SimpleQueue()
        self.waiting = 0
        threading.Thread(target=self._run, daemon=True, name="solver").start()

    async def answer(self, action: Callable[[], Response]) -> Response:
        """What an action returns; refused where too many wait."""
        if self.waiting >= MOST_WAITING:
            return refusal(503)
        future: asyncio.Future[Response] = asyncio.get_running_loop().create_future()
        self.waiting += 1
        try:
            self.work.put((future, action))
            return await future
        finally:
            self.waiting -= 1

    def _run(self) -> None:
        while True:
            future, action = self.work.get()
            try:
                response = action()
            except Refused as error:
                response = refusal(error.status)
            except Exception as error:
                print_fault(error)
                response = refusal(500)
            future.get_loop().call_soon_threadsafe(_settle, future, response)


def _settle(future: asyncio.Future[Response], response: Response) -> None:
    if not future.done():
        future.set_result(response)


def print_fault(error: Exception) -> None:
    """A fault of the program, on stderr: the page says nothing of it."""
    import traceback

    sys.stderr.write("".join(traceback.format_exception(error)))


class Server:
    """Connections to the page of a study."""

    def __init__(self, site: Site) -> None:
        self.site, self.solver = site, Solver()
        self.reading: dict[asyncio.Task[Any], None] = {}

    async def connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Read, answer and close a connection."""
        task = asyncio.current_task()
        assert task is not None
        try:
            response = await self._answered(reader, task)
        except (asyncio.CancelledError, OSError):
            writer.transport.abort()
            return
        await write(reader, writer, response)

    async def _answered(self, reader: asyncio.StreamReader, task: asyncio.Task[Any]) -> Response:
        if len(self.reading) >= MOST_READ:
            next(iter(self.reading)).cancel()
        self.reading[task] = None
        try:
            request = await read(reader)
            route = admit(self.site, request)
        except Refused as error:
            return refusal(error.status)
        finally:
            self.reading.pop(task, None)
        return await self.solver.answer(lambda: respond(self.site, route, request.body))


async def _serve(board: Board, port: int, started: Callable[[str], None]) -> None:
    server: list[Server] = []

    async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await server[0].connected(reader, writer)

    listening = await asyncio.start_server(connected, "127.0.0.1", port, limit=MOST_HEAD, backlog=128)
    at = listening.sockets[0].getsockname()[1]
    site = Site(board, at, secrets.token_urlsafe(24))
    server.append(Server(site))
    started(site.url)
    async with listening:
        await _until_the_parent_ends()


async def _until_the_parent_ends() -> None:
    """Until the process that started this one is gone, and another has taken it over."""
    parent = os.getppid()
    while os.getppid() == parent:
        await asyncio.sleep(LOOK)


def serve(board: Board, port: int, started: Callable[[str], None]) -> None:
    """Answer the page of a study until the process is told to end, or its parent ends.

    Parameters
    ----------
    board : Board
    port : int
        0 for any that is free.
    started : function
        Called with the address once it can be opened.

    Raises
    ------
    OSError
        The port is taken.
    """
    import matplotlib

    matplotlib.use("agg")  # pictures are drawn beside the main thread, where windows cannot be
    asyncio.run(_serve(board, port, started))
