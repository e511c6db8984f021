"""Requests that no good client sends, made from good ones by fixed-seed mutation, and a worker that sends them."""

import json
import random
import select
import socket
import ssl
import time
import zlib

TELLING = [b"{", b"}", b"[", b"]", b'"', b",", b":", b"-", b"+", b".", b"e", b"0", b"9", b"\r\n", b"\n", b" ", b"\x00", b"\x80",
           b"\xff", b"%00", b"../", b"99999999999999999999", b"-1", b"1e999", b"null", b"A" * 300, b"[" * 500]


def mutate(data, rng, edits=4):
    """Flips bits, overwrites, cuts, doubles, inserts; often enough with bytes that mean something to a parser."""
    data = bytearray(data)
    for _ in range(rng.randint(1, edits)):
        if not data:
            break
        at = rng.randrange(len(data))
        kind = rng.randrange(6)
        if kind == 0:
            data[at] ^= 1 << rng.randrange(8)
        elif kind == 1:
            data[at:at + 1] = rng.choice(TELLING)
        elif kind == 2 and rng.random() < 0.3:
            del data[at:]
        elif kind == 3:
            data[at:at] = data[at:at + rng.randrange(64)]
        elif kind == 4:
            data[at:at] = rng.choice(TELLING)
        else:
            del data[at:at + rng.randrange(1, 16)]
    return bytes(data)


def small_template(template, points=200):
    """The same template with fewer points: quick to send, with all that a parser reads."""
    line, _, rest = template.partition(b"\n")
    header = json.loads(rest[:int(line.split()[3])])
    cloud = rest[int(line.split()[3]):]
    count, header["points"] = header["points"], points
    return sealed(json.dumps(header).encode(), cloud[:12 * points] + cloud[12 * count:12 * (count + points)])


def sealed(header, points):
    """A template of these two, its checksum right."""
    return b"beltpick-template 1 %08x %d\n" % (zlib.crc32(header + points), len(header)) + header + points


class Requests:
    """Makes requests; `items`: good files by kind, `token`: a commissioner's."""

    ITEMS = ("calibration/calibration", "cell/cell", "template/fuzz1", "template/fuzz2", "recipe/fuzz3")
    LOOKS = ("health", "status", "items", "tokens", "result-codes", "self-test", "openapi.json", "items/template/fuzz1",
             "items/recipe/fuzz3/versions", "items/template/fuzz1/versions/1", "nothing", "")
    METHODS = ("GET", "PUT", "POST", "DELETE", "HEAD", "PATCH", "OPTIONS", "CONNECT", "TRACE", "BREW", "get", "")
    BODIES = {"tokens": b'{"name": "fuzz", "role": "viewer"}', "enrol": b'{"token": "%s", "name": "fuzz"}' % (b"0" * 64),
              "items/template/fuzz1/rollback": b'{"version": 3}', "items/recipe/fuzz3/rollback": b'{"version": 1}'}

    def __init__(self, seed, token, items):
        self.rng, self.token, self.items = random.Random(seed), token, items
        self.small = small_template(items["template"])

    def head(self, method, path, body=b"", length=None, token=None):
        length = len(body) if length is None else length
        lines = [f"{method} /api/v1/{path} HTTP/1.1", "Host: localhost", f"Authorization: Bearer {token or self.token}"]
        if length or method in ("PUT", "POST"):
            lines.append(f"Content-Length: {length}")
        return "\r\n".join(lines).encode() + b"\r\n\r\n"

    def damaged(self, kind):
        """A damaged file of a kind; of templates every other one with a checksum that fits, few of full size."""
        if kind != "template":
            return mutate(self.items[kind], self.rng, 6)
        if self.rng.random() < 0.02:
            return mutate(self.items["template"], self.rng, 6)
        if self.rng.random() < 0.5:
            return mutate(self.small, self.rng, 6)
        line, _, rest = self.small.partition(b"\n")
        length = int(line.split()[3])
        return sealed(mutate(rest[:length], self.rng), rest[length:])

    def good(self):
        """A request in order; and whether it is one that could change what the cell works with."""
        rng = self.rng
        kind = rng.random()
        if kind < 0.4:
            return self.head("GET", rng.choice(self.LOOKS))
        if kind < 0.6:
            path = rng.choice(list(self.BODIES))
            return self.head("POST", path, self.BODIES[path]) + self.BODIES[path]
        if kind < 0.7:
            return self.head("DELETE", rng.choice(("items/template/fuzz2", "items/recipe/fuzz3", "tokens/fuzz")))
        item = rng.choice(("template/fuzz1", "recipe/fuzz3"))
        body = self.items["recipe"] if item.startswith("recipe") else self.small
        return self.head("PUT", "items/" + item, body) + body

    def next(self):
        """(name of the kind, bytes): malformed in head, body, framing or sense."""
        rng, kind = self.rng, self.rng.random()
        if kind < 0.30:
            request = self.good()
            end = request.index(b"\r\n\r\n")
            return "head", mutate(request[:end], rng) + request[end:]
        if kind < 0.60:
            item = rng.choice(self.ITEMS)
            body = self.damaged(item.split("/")[0])
            return "upload", self.head("PUT", "items/" + item, body) + body
        if kind < 0.75:
            path = rng.choice(list(self.BODIES))
            body = mutate(self.BODIES[path], rng)
            return "json", self.head("POST", path, body) + body
        if kind < 0.88:
            path = mutate(rng.choice(self.LOOKS).encode(), rng).decode("latin-1").replace("\r", "").replace("\n", "")
            return "path", self.head(rng.choice(self.METHODS), path.replace(" ", "")).replace(b"\x00", b"%00")
        if kind < 0.93:
            return "token", self.head("GET", "status", token="%064x" % rng.getrandbits(256))
        if kind < 0.97:  # announced and sent lengths differ
            body = self.items["recipe"]
            length = max(0, len(body) + rng.randint(-50, 50)) if rng.random() < 0.9 else rng.getrandbits(80)
            return "length", self.head("PUT", "items/recipe/fuzz3", length=length) + body
        return "noise", rng.randbytes(rng.randint(1, 2000))


class Sender:
    """One client: keeps its connection while the server does, and comes from another loopback address each time."""

    PATIENCE_S = 0.5

    def __init__(self, port, certificate, rng):
        self.port, self.rng, self.connection = port, rng, None
        self.context = ssl.create_default_context(cafile=str(certificate))
        self.statuses, self.opened = {}, 0

    def address(self):
        return f"127.{self.rng.randint(20, 40)}.{self.rng.randint(0, 255)}.{self.rng.randint(1, 254)}"

    def open(self):
        plain = socket.create_connection(("127.0.0.1", self.port), 10, source_address=(self.address(), 0))
        plain.settimeout(10)
        plain.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.connection = self.context.wrap_socket(plain, server_hostname="localhost")
        self.opened += 1

    def close(self):
        if self.connection is not None:
            self.connection.close()
        self.connection = None

    def send(self, data):
        """Returns the status answered; 0 where the server closed without one, -1 where it waits for more."""
        try:
            if self.connection is None:
                self.open()
            self.connection.sendall(data)
            status = self.read()
        except OSError:
            status = 0
        if status <= 0:
            self.close()
        self.statuses[status] = self.statuses.get(status, 0) + 1
        return status

    def read(self):
        self.connection.settimeout(self.PATIENCE_S)
        got = b""
        try:
            while b"\r\n\r\n" not in got:
                piece = self.connection.recv(65536)
                if not piece:
                    break
                got += piece
        except TimeoutError:
            return -1
        if not got.startswith(b"HTTP/1."):
            return 0
        head, _, body = got.partition(b"\r\n\r\n")
        fields = dict(line.lower().split(b": ", 1) for line in head.split(b"\r\n")[1:] if b": " in line)
        status = int(head.split(b" ", 2)[1])
        left = int(fields.get(b"content-length", 0)) - len(body)
        self.connection.settimeout(self.PATIENCE_S)
        try:
            while left > 0 and (piece := self.connection.recv(65536)):
                left -= len(piece)
        except TimeoutError:
            self.close()  # the answer of a HEAD has a length and no body
        if left < 0 or fields.get(b"connection") == b"close":
            self.close()  # more answers than one: the request was taken for several
        return status


def slow_clients(port, certificate, seed, stop, count):
    """Holds connections that say nothing, half a handshake, or a request byte by byte, until `stop` is set. `count`
    gets the number of clients."""
    rng = random.Random(seed)
    context = ssl.create_default_context(cafile=str(certificate))
    held = []
    while not stop.is_set():
        if len(held) < 12:
            try:
                plain = socket.create_connection(("127.0.0.1", port), 2, source_address=(f"127.50.0.{rng.randint(1, 250)}", 0))
                plain.settimeout(2)
                kind = rng.randrange(4)
                if kind == 1:
                    plain.sendall(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + rng.randbytes(rng.randint(0, 100)))
                elif kind >= 2:
                    plain = context.wrap_socket(plain, server_hostname="localhost")
                    plain.sendall(b"PUT /api/v1/items/recipe/fuzz3 HTTP/1.1\r\nHost: x\r\n")
                held.append((plain, kind, time.monotonic() + rng.uniform(1, 20)))
                with count.get_lock():
                    count.value += 1
            except OSError:
                pass
        for client in list(held):
            connection, kind, until = client
            try:
                if kind == 3:
                    connection.sendall(b"A")
                ended = time.monotonic() > until or (select.select([connection], [], [], 0)[0] and kind < 2)
            except OSError:
                ended = True
            if ended:
                connection.close()
                held.remove(client)
        time.sleep(0.1)
    for connection, _, _ in held:
        connection.close()
