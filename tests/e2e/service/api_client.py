"""A client of the HTTPS API made of Python's own ssl and http.client, and raw sockets for what no client would send."""

import http.client
import json
import pathlib
import re
import socket
import ssl
import subprocess
import sys
import time


def expect(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: expected {expected!r}, found {found!r}")


def expect_in(what, found, expected):
    if found not in expected:
        sys.exit(f"{what}: expected one of {expected!r}, found {found!r}")


class Answer:
    def __init__(self, response):
        self.status = response.status
        self.headers = response.headers
        self.body = response.read()

    def json(self):
        return json.loads(self.body)


class Client:
    """Asks from one loopback address of its own, so that limits of an address are met one test at a time."""

    def __init__(self, port, certificate, source="127.0.0.1", token=None, timeout=10):
        self.port, self.source, self.token, self.timeout = port, source, token, timeout
        self.context = ssl.create_default_context(cafile=str(certificate))

    def raw(self):
        """A TCP connection without TLS."""
        return socket.create_connection(("127.0.0.1", self.port), self.timeout, source_address=(self.source, 0))

    def tls(self):
        return self.context.wrap_socket(self.raw(), server_hostname="localhost")

    def connection(self):
        connection = http.client.HTTPConnection("localhost", self.port, timeout=self.timeout)
        connection.sock = self.tls()
        return connection

    def ask(self, method, path, body=None, headers=None, connection=None):
        headers = dict(headers or {})
        if self.token:
            headers.setdefault("Authorization", f"Bearer {self.token}")
        if isinstance(body, (dict, list)):
            body = json.dumps(body).encode()
            headers.setdefault("Content-Type", "application/json")
        own = connection or self.connection()
        own.request(method, "/api/v1" + path, body, headers)
        answer = Answer(own.getresponse())
        if connection is None:
            own.close()
        return answer

    def send(self, data, patience_s=10):
        """Sends bytes over TLS and returns whatever comes back until the server closes or patience ends."""
        with self.tls() as tls:
            tls.settimeout(patience_s)
            got = b""
            try:
                tls.sendall(data)
                while piece := tls.recv(65536):
                    got += piece
            except OSError:
                pass
            return got


class Server:
    """The test server: the service with a real store and a stand-in for the cell."""

    def __init__(self, program, folder, *limits):
        self.folder = pathlib.Path(folder)
        self.state = self.folder / "state"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.log_path = self.folder / "log"
        self.log_file = open(self.log_path, "a")
        self.process = subprocess.Popen([program, str(self.state), *map(str, limits)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=self.log_file, text=True)
        self.port = int(self.process.stdout.readline())
        self.certificate = self.state / "tls" / "certificate.pem"

    def client(self, source="127.0.0.1", token=None, timeout=10):
        return Client(self.port, self.certificate, source, token, timeout)

    def enrol(self, name="anna", source="127.0.0.1"):
        one_time = (self.state / "one_time_token").read_text().strip()
        answer = self.client(source).ask("POST", "/enrol", {"token": one_time, "name": name})
        expect("enrol", answer.status, 201)
        return one_time, answer.json()["token"]

    def log(self):
        return self.log_path.read_text()

    def must_answer(self, source="127.0.0.99"):
        expect("health afterwards", self.client(source).ask("GET", "/health").status, 200)
        expect("the server's process", self.process.poll(), None)

    def must_log(self, pattern, patience_s=15):
        give_up = time.monotonic() + patience_s
        while not re.search(pattern, self.log()):
            if time.monotonic() > give_up:
                sys.exit(f"the log: expected a line like {pattern!r}, found\n{self.log()[-2000:]}")
            time.sleep(0.1)

    def stop(self):
        began = time.monotonic()
        self.process.stdin.close()
        expect("exit code", self.process.wait(10), 0)
        if time.monotonic() - began > 2.0:
            sys.exit("the stop took longer than 2 s")
        self.log_file.close()
