"""Hostile requests to the explorer: each is refused cleanly, none costs memory, and the page is answered meanwhile; it ends with its terminal."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from itertools import chain
from pathlib import Path

import pytest
from command import COMMAND
from explorer_server import body_of, head, post, running, sent, status

from beamprop.explorer.http import MOST_BODY, MOST_HEAD, Refused, parsed

#: Slits on the face of a slab without loss.
SLOW = {"beam.source": "slits", "beam.z0": 0.0, "slab.eta": 0.025, "slab.lossless": True}
GOOD = {"question": "bloch", "state": {}}


@pytest.fixture(scope="module")
def server():
    with running() as server:
        yield server


def children(pid):
    """Processes that a process has started."""
    lists = Path(f"/proc/{pid}/task").glob("*/children")  # each thread has its own
    return [int(child) for each in lists for child in each.read_text(encoding="ascii").split()]


def held(process):
    """Bytes that a process holds, and those that it has started."""
    texts = [Path(f"/proc/{pid}/status").read_text(encoding="ascii") for pid in (process.pid, *children(process.pid))]
    assert len(texts) >= 3  # the server and both processes that answer
    return sum(1024 * int(re.search(r"VmRSS:\s+(\d+) kB", text)[1]) for text in texts)


# --- requests -----------------------------------------------------------------------------------------------


def foreign(server):
    """Of other hosts, origins and sites: (status, request)."""
    names = (
        "evil.example",
        "127.0.0.1",
        f"evil.example:{server.port}",
        "[::1]",
        f"127.0.0.1.evil.example:{server.port}",
        "",
    )
    for name in names:
        yield 403, head(server, fields={"Host": name})
        yield 403, post(server, "curve", GOOD, {"Host": name})
    for origin in (
        "http://evil.example",
        "null",
        f"https://{server.host}",
        "http://127.0.0.1",
        f"http://{server.host}/",
        "file://",
    ):
        yield 403, head(server, fields={"Origin": origin})
        yield 403, post(server, "curve", GOOD, {"Origin": origin})
    for site in ("cross-site", "same-site"):
        yield 403, head(server, fields={"Sec-Fetch-Site": site})
    yield 403, head(server, fields={"Host": None})
    yield 403, post(server, "curve", GOOD, {"Origin": None})


def unknown(server):
    """With a wrong token, or to no route."""
    token = server.token
    for wrong in ("", "x", token[:-1], token + "x", token.swapcase(), token[::-1], "%00", "A" * 1000):
        yield 404, head(server, token=wrong)
        yield 404, head(server, route="board", token=wrong)
    paths = (
        "../",
        "..",
        "../../etc/passwd",
        "%2e%2e/%2e%2e/etc/passwd",
        "..%2fpage.py",
        "page.css/../../server.py",
        "/etc/passwd",
    )
    files = (
        "server.py",
        "__init__.py",
        "page/page.js",
        "page.js.map",
        "board/",
        "board?x=1",
        "page.css?",
        "page.js#x",
        ".git/config",
        "favicon.ico",
        "\\..\\x",
        "~",
        "*",
    )
    for path in paths + files:
        yield 404, head(server, route=path)
        yield 404, post(server, path, GOOD)


def wrong_methods(server):
    """Methods that a route has not, and kinds of body that are not taken."""
    for method in ("PUT", "DELETE", "HEAD", "OPTIONS", "TRACE", "PATCH", "CONNECT", "PROPFIND"):
        yield 405, head(server, method)
    yield 405, head(server, "GET", "curve")
    yield 405, head(server, "POST", "page.js")
    for kind in (
        "text/plain",
        "application/x-www-form-urlencoded",
        "multipart/form-data",
        "application/json; charset=utf-7",
    ):
        yield 415, post(server, "curve", GOOD, {"Content-Type": kind})


def malformed(server):
    """What is no request, or larger than one may be."""
    good, host = head(server), f"Host: {server.host}\r\n".encode()
    first = good.split(b"\r\n")[0]
    for wrong in (
        b"\r\n\r\n",
        b"GET\r\n\r\n",
        b"\x16\x03\x01\x02\x00\r\n\r\n",
        b"get / HTTP/1.1\r\n\r\n",
        b"GET / HTTP/2.0\r\n\r\n",
        b"GET http://x/ HTTP/1.1\r\n\r\n",
    ):
        yield 400, wrong
    for field in (b"no colon", b" folded: x", b"a b: c", b": x", b"x\x00y: z", b"x: \xff", host.strip()):
        yield 400, first + b"\r\n" + host + field + b"\r\n\r\n"
    yield 431, first + b"\r\n" + host + b"X: " + b"a" * 2 * MOST_HEAD + b"\r\n\r\n"
    yield 431, b"GET /" + b"a" * 100_000
    yield 413, post(server, "curve", b"", {"Content-Length": str(10**11)})
    yield 413, post(server, "curve", b" " * (MOST_BODY + 1))
    yield 413, post(server, "curve", b"x" * 3_000_000)
    for length in ("-1", "1e3", "0x10", "", "9" * 40, "1, 1"):
        yield 400, post(server, "curve", b"", {"Content-Length": length})
    yield (
        411,
        head(server, "POST", "curve", {"Content-Type": "application/json", "Transfer-Encoding": "chunked"})
        + b"0\r\n\r\n",
    )


def odd_json(server):
    """Bodies that are no table of finite numbers."""
    deep = b"[" * 30_000 + b"]" * 30_000
    texts = (
        b"",
        b"{",
        b"[]",
        b"null",
        b"1",
        b'"x"',
        b"\xff\xfe",
        b'{"a": NaN}',
        b'{"a": Infinity}',
        b'{"a": -Infinity}',
        b'{"a": 1e999}',
        deep,
    )
    for text in (
        *texts,
        b'{"a":' * 9000 + b"1" + b"}" * 9000,
        b'{"a":' + b"9" * 60_000 + b"}",
        b'{"question": "bloch", "state": {"x": [[[[[[[[[1]]]]]]]]]}}',
    ):
        yield 400, post(server, "curve", text)


def wrong_values(server):
    """Tables that the study cannot use: a refusal that says why."""
    questions = (None, 1, "fem", "../field", ["bloch"], {"a": 1}, "__class__")
    bodies = [{"question": question, "state": {}} for question in questions]
    bodies += [
        {"question": "field", "state": state}
        for state in (None, [], 3, "x", {"slab.layers": "/etc/passwd"}, {"beam.profile": "x.txt"})
    ]
    bodies += [
        {"question": "field", "state": {"output.file": "x.nc"}},
        {"question": "field", "state": {"__proto__": 1}},
        {},
        {"question": "field"},
    ]
    bodies += [
        {"question": "field", "state": {}, "path": "/etc"},
        {"question": "field", "state": {"slab.medium": "\x00"}},
    ]
    values = (1e308, -1e308, 5e-324, 10**300, "1", None, True, [1], {"a": 1}, -1)
    paths = ("slab.eta", "slab.periods", "slab.n_layers", "question.frequency", "beam.fwhm", "view.x")
    bodies += [{"question": "field", "state": {path: value}} for path in paths for value in values]
    for body in bodies:
        yield 422, post(server, "curve", body)
    yield 422, post(server, "file", {"question": "bloch", "state": {}, "kind": "../x", "quantity": "abs"})
    yield 422, post(server, "file", {"question": "field", "state": {}, "kind": "png", "quantity": "x"})
    yield 422, post(server, "texts", {"question": "x", "state": {}})


def hostile(server):
    return list(chain(*(make(server) for make in (foreign, unknown, wrong_methods, malformed, odd_json, wrong_values))))


def test_hostile_requests_are_refused_and_memory_stays_flat(server):
    """Each of more than 200 with its status, all headers of the page's policy, and no word of the server's insides; again and again."""
    requests = hostile(server)
    assert len(requests) > 200
    wrong = []
    for number, (expected, request) in enumerate(requests):
        answer = sent(server, request)
        if status(answer) != expected:
            wrong.append((number, expected, status(answer), request[-120:], body_of(answer)[:200]))
        assert b"default-src 'none'" in answer
        assert b"Traceback" not in answer
        assert b"File " not in answer
        if status(answer) == 422:
            assert json.loads(body_of(answer))["error"]
    assert wrong == []
    before = held(server.process)
    for _, request in requests:
        sent(server, request)
    assert held(server.process) - before < 16e6
    assert status(sent(server, head(server))) == 200


def test_slow_clients_cost_nothing(server):
    """Two hundred that send half a request and wait: a question is answered at once meanwhile, and they are let go of."""
    slow = [socket.create_connection(("127.0.0.1", server.port), 10) for _ in range(200)]
    try:
        for i, client in enumerate(slow):
            client.sendall((b"", b"GET /", post(server, "curve", GOOD)[:-1])[i % 3])
        start = time.perf_counter()
        assert status(sent(server, post(server, "curve", GOOD))) == 200
        assert time.perf_counter() - start < 2
        threads = re.search(r"Threads:\s+(\d+)", Path(f"/proc/{server.process.pid}/status").read_text(encoding="ascii"))
        assert int(threads[1]) < 20
        last = slow[-1]
        last.settimeout(15)
        assert status(last.recv(65536)) == 408
    finally:
        for client in slow:
            client.close()


def test_the_page_is_served_with_a_strict_policy(server):
    """Nothing inline, nothing from elsewhere, nothing kept."""
    answer = sent(server, head(server)).decode()
    policy = re.search("Content-Security-Policy: (.*)\r\n", answer)[1]
    assert "unsafe" not in policy
    assert "*" not in policy
    assert policy.startswith("default-src 'none'; script-src 'self'")
    page = body_of(answer.encode()).decode()
    assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\sstyle=|\son\w+=|https?://", page)


def test_the_host_may_be_localhost(server):
    assert status(sent(server, head(server, fields={"Host": f"localhost:{server.port}"}))) == 200


@pytest.mark.parametrize(
    "text",
    ["GET / HTTP/1.1\r\nA: b\nC: d\r\n\r\n", "GET /\x7f HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\na: b\r\nA: c\r\n\r\n"],
)
def test_a_head_that_can_be_read_in_two_ways_is_refused(text):
    with pytest.raises(Refused):
        parsed(text.encode("latin-1"))


# --- how it ends --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, -signal.SIGHUP)]
)
def test_it_ends_by_the_signals_of_a_terminal(number, code):
    """Ctrl-C, kill, and a terminal that is closed; also while a question is being answered."""
    with running() as server:
        with socket.create_connection(("127.0.0.1", server.port), 10) as client:
            client.sendall(post(server, "map", {"question": "field", "state": {}}))
            server.process.send_signal(number)
            assert server.process.wait(timeout=10) == code
        with pytest.raises(OSError, match="refused"):
            socket.create_connection(("127.0.0.1", server.port), 2)


def test_it_ends_when_its_parent_does():
    """A parent that is killed cannot pass anything on; no process of the page is left."""
    start = f"import subprocess, sys, time; p = subprocess.Popen([sys.executable, '-c', {COMMAND!r}, 'explore', '--no-open']); print(p.pid, flush=True); time.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", start], stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        assert parent.stdout.readline().startswith("http://127.0.0.1:")
        started = [child, *children(child)]
        parent.kill()
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline and any(map(_runs, started)):
        time.sleep(0.1)
    assert not any(map(_runs, started))


def _runs(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").split()[2] != "Z"


def test_a_port_that_is_taken_is_an_error(server):
    """Exit code 1, and the reason on stderr."""
    command = [sys.executable, "-c", COMMAND, "explore", "--no-open", "--port", str(server.port)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 1
    assert done.stdout == ""
    assert "address already in use" in done.stderr.lower()


def test_what_runs_too_long_is_ended():
    """Many plane waves, which no count of layers tells, are refused at the limit; what is given up is ended; both are answered after."""
    with running() as server:
        slow, quick = (
            post(server, "curve", {"question": q, "state": s}) for q, s in (("beam_width", SLOW), ("bloch", {}))
        )
        answer = sent(server, slow)
        assert status(answer) == 422
        assert b"at most 5 s, got one that takes longer" in answer
        assert status(sent(server, quick)) == 200
        before = set(children(server.process.pid))
        with socket.create_connection(("127.0.0.1", server.port), 10) as client:
            client.sendall(slow)
            time.sleep(1.0)
        assert status(sent(server, quick)) == 200
        assert len(before - set(children(server.process.pid))) == 1
