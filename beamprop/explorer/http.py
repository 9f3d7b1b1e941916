"""The part of HTTP that the page needs, read strictly: one small request a connection, within a time, and nothing that is not understood."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

#: Bytes of a request's head and of its body, at most.
MOST_HEAD, MOST_BODY = 8192, 65536
#: Seconds for the whole request to arrive, for its answer to be taken, and for the client to leave.
READING, WRITING, LEAVING = 5.0, 20.0, 1.0
_LINE = re.compile(rb"([A-Z]{1,16}) (/[!-~]{0,2000}) HTTP/1\.[01]")
_FIELD = re.compile(rb"([!#$%&'*+.^_`|~0-9A-Za-z-]{1,64}):[ \t]*([\t -~]*?)[ \t]*")
REASONS = {
    200: "OK",
    400: "Bad Request",
    403: "Forbidden",
    404: "Not Found",
    405: "Method Not Allowed",
    408: "Request Timeout",
    411: "Length Required",
    413: "Content Too Large",
    415: "Unsupported Media Type",
    422: "Unprocessable Content",
    431: "Request Header Fields Too Large",
    500: "Internal Server Error",
    503: "Service Unavailable",
}
#: What every answer says: nothing but the page's own files runs, nothing is kept, framed, guessed or sent elsewhere.
GUARDS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Connection": "close",
}


class Refused(Exception):
    """A request that is answered with a status alone."""

    def __init__(self, status: int) -> None:
        super().__init__(REASONS[status])
        self.status = status


@dataclass(frozen=True)
class Request:
    """A request: names of its fields are in small letters."""

    method: str
    target: str
    fields: Mapping[str, str]
    body: bytes = b""


@dataclass(frozen=True)
class Response:
    """An answer."""

    status: int = 200
    body: bytes = b""
    kind: str = "text/plain; charset=utf-8"
    fields: Mapping[str, str] = field(default_factory=dict)

    def head(self) -> bytes:
        """Its first lines."""
        own = {"Content-Type": self.kind, "Content-Length": str(len(self.body))}
        lines = [f"{name}: {value}" for name, value in (own | GUARDS | dict(self.fields)).items()]
        return "\r\n".join([f"HTTP/1.1 {self.status} {REASONS[self.status]}", *lines, "", ""]).encode("latin-1")


def refusal(status: int) -> Response:
    """The answer to a request that is refused."""
    return Response(status, f"{status} {REASONS[status]}\n".encode())


async def read(reader: asyncio.StreamReader) -> Request:
    """The request of a connection.

    Raises
    ------
    Refused
        It is too large, too slow, or not understood.
    """
    try:
        async with asyncio.timeout(READING):
            head = await reader.readuntil(b"\r\n\r\n")
            request = parsed(head)
            return Request(request.method, request.target, request.fields, await _body(reader, request))
    except TimeoutError:
        raise Refused(408) from None
    except asyncio.LimitOverrunError:
        raise Refused(431) from None
    except asyncio.IncompleteReadError:
        raise Refused(400) from None


def parsed(head: bytes) -> Request:
    """A request out of its head.

    Examples
    --------
    >>> from beamprop.explorer.http import parsed
    >>> parsed(b"GET /x HTTP/1.1\\r\\nHost: a\\r\\n\\r\\n").fields
    {'host': 'a'}
    """
    first, *rest = head.removesuffix(b"\r\n\r\n").split(b"\r\n")
    line = _LINE.fullmatch(first)
    matches = [_FIELD.fullmatch(each) for each in rest]
    if line is None or None in matches:
        raise Refused(400)
    pairs = [(m[1].decode().lower(), m[2].decode()) for m in matches if m is not None]
    fields = dict(pairs)
    if len(fields) != len(pairs):  # twice the same field can be read in two ways
        raise Refused(400)
    return Request(line[1].decode(), line[2].decode(), fields)


async def _body(reader: asyncio.StreamReader, request: Request) -> bytes:
    if "transfer-encoding" in request.fields or "expect" in request.fields:
        raise Refused(411)
    length = request.fields.get("content-length", "0")
    if not re.fullmatch("[0-9]{1,12}", length):
        raise Refused(400)
    if int(length) > MOST_BODY:
        raise Refused(413)
    return await reader.readexactly(int(length))


async def write(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, response: Response) -> None:
    """Send an answer, and close; a client that does not take it is left.

    What a refused client still sends is thrown away for a moment: a connection that is closed over it is reset, and the answer lost.
    """
    with contextlib.suppress(TimeoutError, OSError):
        async with asyncio.timeout(WRITING):
            writer.write(response.head() + response.body)
            await writer.drain()
            writer.write_eof()
        async with asyncio.timeout(LEAVING):
            for _ in range(MOST_BODY):
                if not await reader.read(MOST_HEAD):
                    break
    writer.transport.abort()
