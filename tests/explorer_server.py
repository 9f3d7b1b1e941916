"""The explorer as a process of its own, and requests to it as bytes."""

import json
import os
import socket
import subprocess
import sys
from contextlib import closing, contextmanager
from typing import NamedTuple
from urllib.parse import urlsplit

from command import COMMAND


class Running(NamedTuple):
    """A server: its address, and its process."""

    url: str
    process: subprocess.Popen

    @property
    def port(self):
        return urlsplit(self.url).port

    @property
    def token(self):
        return urlsplit(self.url).path.strip("/")

    @property
    def host(self):
        return f"127.0.0.1:{self.port}"


@contextmanager
def running(*arguments):
    """`beamprop explore` until the block ends."""
    command = [sys.executable, "-c", COMMAND, "explore", "--no-open", *map(str, arguments)]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    ) as process:
        try:
            yield Running(process.stdout.readline().strip(), process)
        finally:
            process.terminate()
            process.communicate(timeout=20)


def sent(server, request, timeout=20.0):
    """The whole answer to the bytes of a request."""
    with closing(socket.create_connection(("127.0.0.1", server.port), timeout)) as client:
        client.settimeout(timeout)
        client.sendall(request)
        parts = []
        while part := client.recv(65536):
            parts.append(part)
        return b"".join(parts)


def status(answer):
    """The status of an answer."""
    return int(answer.split(b" ", 2)[1])


def head(server, method="GET", route="", fields=None, token=None):
    """The head of a request, as a page of the server makes it but for what is given."""
    own = {"Host": server.host} | ({"Origin": f"http://{server.host}"} if method == "POST" else {})
    lines = [f"{name}: {value}" for name, value in (own | (fields or {})).items() if value is not None]
    return "\r\n".join(
        [f"{method} /{server.token if token is None else token}/{route} HTTP/1.1", *lines, "", ""]
    ).encode()


def post(server, route, body, fields=None):
    """The bytes of a POST of JSON."""
    text = body if isinstance(body, bytes) else json.dumps(body).encode()
    own = {"Content-Type": "application/json", "Content-Length": str(len(text))}
    return head(server, "POST", route, own | (fields or {})) + text


def body_of(answer):
    """What stands behind the head of an answer."""
    return answer.partition(b"\r\n\r\n")[2]
