"""Which requests there are, and who may make them: a fixed table, behind a token, for pages of this address alone."""

from __future__ import annotations

import hmac
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

from .controls import Board
from .http import Refused, Request, Response

SCRIPTS = ("plots.js", "map.js", "state.js", "sliders.js", "page.js")
#: Route -> file of the page, and its type.
FILES = {
    "": ("page.html", "text/html; charset=utf-8"),
    "page.css": ("page.css", "text/css; charset=utf-8"),
    **{name: (name, "text/javascript; charset=utf-8") for name in SCRIPTS},
}
#: Files that are handed out: their types.
KINDS = {"nc": "application/x-netcdf", "png": "image/png", "pdf": "application/pdf", "svg": "image/svg+xml"}
MOST_DEPTH = 8


@dataclass(frozen=True)
class Site:
    """The page of a study at a port."""

    board: Board
    port: int
    token: str

    @property
    def hosts(self) -> tuple[str, ...]:
        """The names that a browser may have it under."""
        return f"127.0.0.1:{self.port}", f"localhost:{self.port}"

    @property
    def url(self) -> str:
        """Its address."""
        return f"http://{self.hosts[0]}/{self.token}/"


def text_of(name: str) -> bytes:
    """A file of the page."""
    return (resources.files("beamprop.explorer") / "page" / name).read_bytes()


def admit(site: Site, request: Request) -> str:
    """The route of a request that may be made: what follows the token.

    A page of another origin has another Origin, one whose name was bound to this address another Host; neither knows the token.

    Raises
    ------
    Refused
    """
    fields = request.fields
    if fields.get("host") not in site.hosts:
        raise Refused(403)
    if "origin" in fields and fields["origin"] not in [f"http://{host}" for host in site.hosts]:
        raise Refused(403)
    if fields.get("sec-fetch-site", "none") not in ("none", "same-origin"):
        raise Refused(403)
    token, slash, route = request.target[1:].partition("/")
    if not hmac.compare_digest(token.encode(), site.token.encode()) or not slash:
        raise Refused(404)
    if route not in FILES and route not in POSTED and route != "board":
        raise Refused(404)
    if request.method != ("POST" if route in POSTED else "GET"):
        raise Refused(405)
    if route in POSTED and fields.get("content-type") != "application/json":
        raise Refused(415)
    if route in POSTED and "origin" not in fields:
        raise Refused(403)
    return route


def respond(board: Board, route: str, body: bytes) -> Response:
    """The answer on a route; a ValueError of the package is said in the page."""
    if route in FILES:
        name, kind = FILES[route]
        return Response(body=text_of(name), kind=kind)
    if route == "board":
        from .start import board_text

        return Response(body=board_text(board), kind="application/json")
    try:
        return POSTED[route](board, read_json(body))
    except ValueError as error:
        return Response(422, json.dumps({"error": str(error)}).encode(), "application/json")
    except MemoryError:
        return Response(422, b'{"error": "expected a question that fits into memory"}', "application/json")


def read_json(body: bytes) -> dict[str, Any]:
    """A table out of JSON: nothing but finite numbers, and nothing deep.

    Raises
    ------
    Refused
    """
    try:
        value = json.loads(body.decode("utf-8"), parse_constant=_refuse, parse_float=_finite)
    except (ValueError, RecursionError):
        raise Refused(400) from None
    if not isinstance(value, dict) or _depth(value) > MOST_DEPTH:
        raise Refused(400)
    return value


def _refuse(text: str) -> float:
    raise ValueError(text)


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse(text)


def _depth(value: Any, level: int = 0) -> int:
    if level > MOST_DEPTH or not isinstance(value, dict | list):
        return level
    inner = value.values() if isinstance(value, dict) else value
    return max((_depth(each, level + 1) for each in inner), default=level + 1)


def _answer(board: Board, sent: Mapping[str, Any]) -> Response:
    from .panels import answer

    _only(sent, "question", "state")
    return Response(body=answer(board, sent["question"], sent["state"]), kind="application/octet-stream")


def _texts(board: Board, sent: Mapping[str, Any]) -> Response:
    from .equivalents import texts

    _only(sent, "question", "state")
    return Response(body=json.dumps(texts(board, sent["question"], sent["state"])).encode(), kind="application/json")


def _file(board: Board, sent: Mapping[str, Any]) -> Response:
    from .. import validate
    from .downloads import file

    _only(sent, "question", "state", "kind", "quantity")
    kind = validate.word(sent["kind"], "kind", *KINDS)
    made = file(board, sent["question"], sent["state"], kind, sent["quantity"])
    return Response(body=made, kind=KINDS[kind])


def _only(sent: Mapping[str, Any], *names: str) -> None:
    if set(sent) != set(names):
        raise ValueError(f"request: expected {', '.join(names)}, got {', '.join(map(str, sent))[:80] or 'nothing'}")


#: Maps and curves are asked for apart, so that they are answered beside each other.
POSTED: dict[str, Callable[[Board, Mapping[str, Any]], Response]] = {
    "map": _answer,
    "curve": _answer,
    "texts": _texts,
    "file": _file,
}
