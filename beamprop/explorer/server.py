"""The server: it listens at 127.0.0.1 alone, and ends with the terminal that it was started from.

Requests are read by one thread, which waits for no client: a slow one takes a place of `MOST_READ` and nothing else, and where all are taken, the
request that is longest on its way gives up its own. Questions are answered by two processes, for curves and for all else, so that two cores follow a
slider and requests are read meanwhile; each takes one at a time.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import json
import multiprocessing
import os
import queue
import secrets
import signal
import sys
import threading
import time
from collections.abc import Callable, Coroutine
from multiprocessing.connection import Connection
from typing import Any

from . import cost
from .controls import Board
from .http import MOST_HEAD, Refused, Response, read, refusal, write
from .routes import POSTED, Site, admit, respond

#: Connections at a time whose request is still read, and requests that wait for an answer.
MOST_READ, MOST_WAITING = 64, 16
#: Seconds between two looks at the parent process.
LOOK = 1.0
#: Seconds between two looks at whether an answer is still wanted; and what a file may take, for which fonts may have to be listed first.
GLANCE, FILE_SECONDS = 0.1, 60.0


class Solver:
    """A thread that passes one request at a time on to a process, and ends with its own whatever it waits for."""

    def __init__(self, child: Child) -> None:
        self.child = child
        self.work: queue.SimpleQueue[tuple[asyncio.Future[Response], str, bytes]] = queue.SimpleQueue()
        self.waiting = 0
        threading.Thread(target=self._run, daemon=True, name="solver").start()

    async def ask(self, route: str, body: bytes) -> Response:
        """The answer to a request; refused where too many wait."""
        if self.waiting >= MOST_WAITING:
            return refusal(503)
        future: asyncio.Future[Response] = asyncio.get_running_loop().create_future()
        self.waiting += 1
        try:
            self.work.put((future, route, body))
            return await future
        finally:
            self.waiting -= 1

    def _run(self) -> None:
        while True:
            future, route, body = self.work.get()
            if future.cancelled():
                continue
            response = self.child.answer(route, body, future.cancelled)
            future.get_loop().call_soon_threadsafe(_settle, future, response)


def answered(board: Board, route: str, body: bytes) -> Response:
    """The answer on a route, whatever goes wrong."""
    try:
        return respond(board, route, body)
    except Refused as error:
        return refusal(error.status)
    except Exception as error:
        print_fault(error)
        return refusal(500)


class Child:
    """A process that answers as `answered` does; another takes its place if it is lost, or takes too long."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_answer_all, args=(theirs, self.board), daemon=True)
        self.process.start()
        self.ready = False
        theirs.close()

    def answer(self, route: str, body: bytes, given_up: Callable[[], bool] = lambda: False) -> Response:
        """The answer to a request; a refusal where it takes too long, or nobody waits for it any more."""
        try:
            if not self.ready:  # its imports are no part of a question's time
                self.ready = self.connection.recv()
            self.connection.send((route, body))
            end = time.monotonic() + (FILE_SECONDS if route == "file" else cost.MOST_SECONDS)
            while not self.connection.poll(GLANCE):
                if given_up() or time.monotonic() > end:
                    self._replace()
                    return Response(422, json.dumps({"error": cost.TOO_LONG}).encode(), "application/json")
            response: Response = self.connection.recv()
        except (EOFError, OSError):
            self._replace()
            return refusal(503)
        return response

    def _replace(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()
        self._start()


def _answer_all(connection: Connection, board: Board) -> None:
    """Answer what comes until the other end is closed, which the end of its process does. Ctrl-C in the terminal is for that process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in ("field", "scattering", "bloch", "beam_width"):  # imported on first use
        getattr(importlib.import_module(__name__.partition(".")[0]), name)
    with contextlib.suppress(EOFError, OSError):
        connection.send(True)
        while True:
            connection.send(answered(board, *connection.recv()))


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
        self.site = site
        curves, rest = Solver(Child(site.board)), Solver(Child(site.board))
        self.solvers = {route: curves if route == "curve" else rest for route in POSTED}
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
        if route in self.solvers:
            return await _while_it_is_read(reader, self.solvers[route].ask(route, request.body))
        return answered(self.site.board, route, request.body)


async def _while_it_is_read(reader: asyncio.StreamReader, answer: Coroutine[Any, Any, Response]) -> Response:
    """The answer, which is given up where its client leaves: a page does when a newer state waits long."""
    asked, left = asyncio.ensure_future(answer), asyncio.ensure_future(reader.read(1))
    try:
        await asyncio.wait((asked, left), return_when=asyncio.FIRST_COMPLETED)
        if not asked.done() and left.result():  # more bytes are no farewell
            await asked
        if not asked.done():
            raise ConnectionAbortedError
        return asked.result()
    finally:
        asked.cancel()
        left.cancel()
        await asyncio.gather(left, return_exceptions=True)


async def _serve(board: Board, port: int, started: Callable[[str], None]) -> None:
    parent, server = os.getppid(), list[Server]()

    async def connected(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await server[0].connected(reader, writer)

    listening = await asyncio.start_server(connected, "127.0.0.1", port, limit=MOST_HEAD, backlog=128)
    at = listening.sockets[0].getsockname()[1]
    site = Site(board, at, secrets.token_urlsafe(24))
    server.append(Server(site))
    started(site.url)
    async with listening:
        await _until_it_ends(parent)


async def _until_it_ends(parent: int) -> None:
    """Until the process that started this one is gone, and another has taken it over."""
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
    asyncio.run(_serve(board, port, started))
