"""The HTTPS service asked by a client that is not ours: what it is for, then everything that it must refuse.

    check_service.py SERVER SOURCE_DIR WORK      SERVER: api_test_server

Each test asks from loopback addresses of its own: limits of an address do not reach from one into the next.
"""

import json
import pathlib
import shutil
import socket
import ssl
import sys
import threading
import time
import warnings

from api_client import Client, Server, expect, expect_in

KNUCKLE = "/items/template/knuckle"


def round_trip(server, bench):
    """Upload, download, versions, rollback, removal."""
    client = server.client("127.0.1.1", bench["commissioner"])
    first, second = b"beltpick 1" + bytes(range(256)) * 4000, b"beltpick 2 dusty"
    made = client.ask("PUT", KNUCKLE, first)
    expect("upload", (made.status, made.json()["version"], made.json()["by"]), (201, 1, "anna"))
    expect("the same again", client.ask("PUT", KNUCKLE, first).status, 200)
    got = client.ask("GET", KNUCKLE)
    expect("download", (got.status, got.body == first, got.headers["Beltpick-Version"]), (200, True, "1"))
    expect("ETag", got.headers["ETag"], f'"{made.json()["sha256"]}"')
    expect("Cache-Control", got.headers["Cache-Control"], "no-store")
    head = client.ask("HEAD", KNUCKLE)
    expect("HEAD", (head.status, head.body, head.headers["ETag"]), (200, b"", got.headers["ETag"]))

    made = client.ask("PUT", KNUCKLE, second, {"If-Match": got.headers["ETag"]})
    expect("upload on the version known", (made.status, made.json()["warnings"]), (201, ["knuckle: it is dusty"]))
    stale = client.ask("PUT", KNUCKLE, first, {"If-Match": got.headers["ETag"]})
    expect("upload on a version that is gone", (stale.status, stale.json()["name"]), (412, "VERSION_CHANGED"))
    expect("an older version", client.ask("GET", KNUCKLE + "/versions/1").body, first)
    expect("a version that never was", client.ask("GET", KNUCKLE + "/versions/77").status, 404)
    back = client.ask("POST", KNUCKLE + "/rollback")
    expect("rollback", (back.status, back.json()["origin"]), (201, "rollback to 1"))
    expect("rollback to 2", client.ask("POST", KNUCKLE + "/rollback", {"version": 2}).status, 201)
    expect("what is current", client.ask("GET", KNUCKLE).body, second)
    expect("rollback with nonsense", client.ask("POST", KNUCKLE + "/rollback", {"version": "x"}).status, 422)
    versions = client.ask("GET", KNUCKLE + "/versions").json()["versions"]
    expect("versions", [item["version"] for item in versions], [1, 2, 3, 4])

    expect("removal", client.ask("DELETE", KNUCKLE).json()["removed"], True)
    expect("download of what was removed", client.ask("GET", KNUCKLE).status, 404)
    expect("undone", client.ask("POST", KNUCKLE + "/rollback").status, 201)
    expect("upload of needed", client.ask("PUT", "/items/template/needed", first).status, 201)
    expect("removal of needed", client.ask("DELETE", "/items/template/needed").status, 409)
    none = client.ask("GET", "/self-test").json()
    expect("self-test before any", none, {"format": "beltpick-self-test", "version": 1, "time": None, "worst": None,
                                          "checks": []})
    expect("self-test", client.ask("POST", "/self-test").json()["worst"], "warning")
    refused = client.ask("PUT", "/items/calibration/calibration", b"no json")
    expect("a bad upload", (refused.status, refused.json()["name"]), (422, "FORMAT_INVALID"))
    expect("nothing was stored", client.ask("GET", "/items/calibration/calibration").status, 404)
    server.must_log(r"anna from 127\.0\.1\.1: PUT /api/v1/items/template/knuckle: 201")


def one_connection(server, bench):
    """Many requests over one connection, refused ones among them, and some at once."""
    client = server.client("127.0.1.2", bench["commissioner"])
    connection = client.connection()
    for _ in range(20):
        expect("status", client.ask("GET", "/status", connection=connection).status, 200)
        expect("refused upload", client.ask("PUT", "/items/cell/cell", b"x" * 300, connection=connection).status, 422)
        expect("no such path", client.ask("GET", "/nothing", connection=connection).status, 404)
    one = b"GET /api/v1/health HTTP/1.1\r\nHost: x\r\n\r\n"
    answers = client.send(one * 5 + one.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))
    expect("requests sent at once", answers.count(b"HTTP/1.1 200 OK"), 6)


def live_answers(server, bench):
    """The document is valid, and what is served fits it; needs jsonschema and openapi_spec_validator."""
    client = server.client("127.0.1.3", bench["commissioner"])
    document = client.ask("GET", "/openapi.json").json()
    try:
        import jsonschema
        from openapi_spec_validator import validate
    except ImportError:
        print("  no openapi_spec_validator here; tests/run makes an environment with it")
        return
    validate(document)
    client.ask("PUT", "/items/recipe/knuckles", b"{}")
    asked = [("get", path, path) for path in ("/health", "/status", "/result-codes", "/self-test", "/items", "/tokens")]
    asked += [("get", "/items/{kind}/{name}/versions", KNUCKLE + "/versions"), ("post", "/self-test", "/self-test"),
              ("post", "/items/{kind}/{name}/rollback", KNUCKLE + "/rollback"),
              ("get", "/items/{kind}/{name}", "/items/template/missing"), ("put", "/items/{kind}/{name}", KNUCKLE),
              ("post", "/tokens", "/tokens"), ("post", "/enrol", "/enrol"), ("delete", "/tokens/{name}", "/tokens/live"),
              ("delete", "/items/{kind}/{name}", "/items/recipe/knuckles")]
    bodies = {"/tokens": {"name": "live", "role": "viewer"}, "/enrol": {"token": "0" * 64}}
    for method, route, path in asked:
        body = bodies.get(path) if method == "post" else b"beltpick!" if method == "put" else None
        answer = client.ask(method.upper(), path, body)
        described = document["paths"]["/api/v1" + route][method]["responses"].get(str(answer.status))
        if described is None:
            sys.exit(f"{method} {path}: status {answer.status} is not described")
        if "$ref" in described:
            described = document["components"]["responses"][described["$ref"].rsplit("/", 1)[1]]
        schema = described["content"]["application/json"]["schema"]
        jsonschema.Draft202012Validator({**schema, "components": document["components"]}).validate(answer.json())


def tokens(server, bench):
    """No token, wrong ones, too little role, a replayed one-time token, a revoked one."""
    expect("no token", server.client("127.0.2.1").ask("GET", "/status").status, 401)
    commissioner = server.client("127.0.2.1", bench["commissioner"])
    viewer = server.client("127.0.2.1",
                           commissioner.ask("POST", "/tokens", {"name": "screen", "role": "viewer"}).json()["token"])
    expect("viewer looks", viewer.ask("GET", "/status").json()["role"], "viewer")
    for method, path in (("PUT", KNUCKLE), ("DELETE", KNUCKLE), ("POST", KNUCKLE + "/rollback"), ("POST", "/self-test"),
                         ("GET", "/tokens"), ("POST", "/tokens"), ("DELETE", "/tokens/anna")):
        refused = viewer.ask(method, path, b"beltpick" if method == "PUT" else None)
        expect(f"viewer, {method} {path}", (refused.status, refused.json()["name"]), (403, "ROLE_TOO_LOW"))
    replayed = server.client("127.0.2.1").ask("POST", "/enrol", {"token": bench["one_time"], "name": "eve"})
    expect("replayed one-time token", (replayed.status, "used already" in replayed.json()["detail"]), (401, True))
    expect("no role named nobody", commissioner.ask("POST", "/tokens", {"name": "x", "role": "nobody"}).status, 422)
    expect("taken name", commissioner.ask("POST", "/tokens", {"name": "screen", "role": "viewer"}).status, 409)
    expect("revoked", commissioner.ask("DELETE", "/tokens/screen").status, 200)
    expect("a revoked token", viewer.ask("GET", "/status").status, 401)
    expect("the last commissioner", commissioner.ask("DELETE", "/tokens/anna").status, 409)


def wrong_tokens(server, bench):
    """After five wrong tokens an address is not heard for a while; others are."""
    for attempt in range(7):
        answer = server.client("127.0.2.2", "0" * 64).ask("GET", "/status")
        expect(f"wrong token {attempt}", answer.status, 401 if attempt < 5 else 429)
    if not 0 < int(answer.headers["Retry-After"]) <= 60:
        sys.exit(f"Retry-After: {answer.headers['Retry-After']}")
    expect("retry_after_s", answer.json()["retry_after_s"], int(answer.headers["Retry-After"]))
    expect("the right token, too late", server.client("127.0.2.2", bench["commissioner"]).ask("GET", "/status").status, 429)
    expect("the right token from elsewhere", server.client("127.0.2.3", bench["commissioner"]).ask("GET", "/status").status,
           200)
    for attempt in range(6):
        answer = server.client("127.0.2.4").ask("POST", "/enrol", {"token": "0" * 64, "name": "eve"})
        expect(f"wrong one-time token {attempt}", answer.status, 401 if attempt < 5 else 429)


def malformed(server, bench):
    """Bytes that no client sends: refused or cut off, and the server goes on."""
    client = server.client("127.0.3.1", bench["commissioner"])
    auth = f"Authorization: Bearer {bench['commissioner']}\r\n".encode()
    put = b"PUT /api/v1/items/template/knuckle HTTP/1.1\r\nHost: x\r\n" + auth
    for what, data, statuses in (
            ("garbage", b"\x00\xff" * 500 + b"\r\n\r\n", (b"", b"400", b"505", b"501")),
            ("no version", b"GET /api/v1/health\r\n\r\n", (b"", b"200", b"400")),
            ("a version to come", b"GET /api/v1/health HTTP/9.9\r\nHost: x\r\n\r\n", (b"", b"400", b"505")),
            ("no host", b"GET /api/v1/health HTTP/1.1\r\n\r\n", (b"400",)),
            ("a header without a colon", b"GET /api/v1/health HTTP/1.1\r\nHost x\r\n\r\n", (b"", b"400")),
            ("40 kB of headers", b"GET /api/v1/health HTTP/1.1\r\nHost: x\r\n" + b"A: " + b"b" * 40000 + b"\r\n\r\n",
             (b"", b"400", b"413", b"414", b"431")),
            ("a path of 40 kB", b"GET /" + b"a" * 40000 + b" HTTP/1.1\r\nHost: x\r\n\r\n",
             (b"", b"400", b"413", b"414", b"431")),
            ("2000 headers", b"GET /api/v1/health HTTP/1.1\r\nHost: x\r\n" + b"A: b\r\n" * 2000 + b"\r\n",
             (b"", b"200", b"400", b"413", b"431")),
            ("an escaped path", b"GET /api/v1/items/template/%2e%2e HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + auth +
             b"\r\n", (b"404",)),
            ("a path that climbs", b"GET /api/v1/items/template/../../tokens HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" +
             auth + b"\r\n", (b"404",)),
            ("chunks", put + b"Transfer-Encoding: chunked\r\n\r\n4\r\nbelt\r\n0\r\n\r\n", (b"411",)),
            ("chunks and a length", put + b"Content-Length: 4\r\nTransfer-Encoding: chunked\r\n\r\n4\r\nbelt\r\n0\r\n\r\n",
             (b"400", b"411")),
            ("two lengths", put + b"Content-Length: 4\r\nContent-Length: 5\r\n\r\nbeltp", (b"", b"400")),
            ("a negative length", put + b"Content-Length: -4\r\n\r\nbelt", (b"", b"400")),
            ("a huge length", put + b"Content-Length: 99999999999999999999999\r\n\r\nbelt", (b"", b"400", b"413")),
            ("more than an item has", put + b"Content-Length: 4194305\r\n\r\nbelt", (b"413",)),
            ("no length", put + b"Connection: close\r\n\r\n", (b"411",)),
            ("a form", put + b"Content-Type: multipart/form-data; boundary=x\r\nContent-Length: 4\r\nConnection: close\r\n\r\n"
             b"belt", (b"415",)),
    ):
        answer = client.send(data, 3)
        status = answer.split(b" ", 2)[1] if answer.startswith(b"HTTP/1.1 ") else answer[:20]
        expect_in(what, status, statuses)
    deep = client.ask("POST", "/tokens", b"[" * 4000, {"Content-Type": "application/json"})
    expect("deeply nested JSON", deep.status, 422)
    wrong_method = client.ask("PATCH", KNUCKLE)
    expect("a method that is not there", (wrong_method.status, wrong_method.headers["Allow"]), (405, "GET, PUT, DELETE"))


def malformed_tls(server, _):
    """What is no TLS, or too old."""
    plain = server.client("127.0.3.2")
    for data in (b"GET /api/v1/health HTTP/1.1\r\nHost: x\r\n\r\n", bytes(range(256)) * 10, b"\x16\x03\x01\xff\xff" + b"a" * 600,
                 b"\x16\x03\x03\x00\x05\x01\x00\x00\x01\x00"):
        with plain.raw() as connection:
            connection.settimeout(3)
            try:
                connection.sendall(data)
                connection.shutdown(socket.SHUT_WR)
                while connection.recv(4096):
                    pass
            except OSError:
                pass
    old = Client(server.port, server.certificate, "127.0.3.3")
    warnings.simplefilter("ignore", DeprecationWarning)  # that is the point
    old.context.minimum_version = ssl.TLSVersion.TLSv1
    old.context.maximum_version = ssl.TLSVersion.TLSv1_1
    old.context.set_ciphers("ALL:@SECLEVEL=0")
    try:
        old.tls().close()
        sys.exit("TLS 1.1: expected to be refused, found it taken")
    except OSError:
        pass
    stranger = ssl.create_default_context()
    try:
        stranger.wrap_socket(plain.raw(), server_hostname="localhost")
        sys.exit("a client that has not pinned the certificate: expected it to refuse")
    except ssl.SSLError:
        pass
    server.must_log("went without a whole request|[Hh]andshake|TLS")


def many_connections(server, bench):
    """One address has its share of the connections, others theirs."""
    greedy = server.client("127.0.4.1", timeout=3)
    held = [greedy.raw() for _ in range(20)]
    time.sleep(0.5)
    alive = 0
    for connection in held:
        connection.settimeout(0.05)
        try:
            alive += connection.recv(1) != b""
        except TimeoutError:
            alive += 1
        except OSError:
            pass
    if alive > 8:
        sys.exit(f"connections of one address: expected at most 8, found {alive}")
    expect("another address", server.client("127.0.4.2", bench["commissioner"]).ask("GET", "/status").status, 200)
    for connection in held:
        connection.close()


def one_upload_at_a_time(server, bench):
    """While one uploads another is asked to wait; a client that goes away in the midst of it hinders nobody."""
    slow = server.client("127.0.5.1", bench["commissioner"])
    with slow.tls() as tls:
        tls.sendall(b"PUT /api/v1/items/template/slow HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\nAuthorization: Bearer " +
                    bench["commissioner"].encode() + b"\r\n\r\nbeltpick")
        time.sleep(0.3)
        refused = server.client("127.0.5.2", bench["commissioner"]).ask("PUT", KNUCKLE, b"beltpick second")
        expect("a second upload", (refused.status, refused.json()["name"]), (503, "SERVICE_BUSY"))
        expect("a look meanwhile", server.client("127.0.5.2", bench["commissioner"]).ask("GET", "/items").status, 200)
    give_up = time.monotonic() + 5
    while server.client("127.0.5.2", bench["commissioner"]).ask("PUT", KNUCKLE, b"beltpick third").status == 503:
        if time.monotonic() > give_up:
            sys.exit("the upload buffer was not given back")
        time.sleep(0.1)
    expect("what was broken off", server.client("127.0.5.2", bench["commissioner"]).ask("GET", "/items/template/slow").status,
           404)


def many_at_once(server, bench):
    """Twenty clients together: whatever is answered is whole."""
    problems = []

    def work(number):
        client = server.client(f"127.0.6.{1 + number % 10}", bench["commissioner"], timeout=30)
        try:
            for turn in range(5):
                body = b"beltpick %d %d " % (number, turn) * 1000
                upload = client.ask("PUT", f"/items/template/part{number}", body)
                if upload.status == 201 and client.ask("GET", f"/items/template/part{number}").body != body:
                    problems.append(f"part{number} came back as another")
                if upload.status not in (201, 503):
                    problems.append(f"upload: {upload.status}")
        except OSError as problem:
            problems.append(str(problem))

    threads = [threading.Thread(target=work, args=(number,)) for number in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expect("problems", problems, [])


def slow_clients(program, work):
    """Clients that send little by little, or nothing: cut off after a total time, whatever they send meanwhile."""
    server = Server(program, work / "slow", 100000, 2)
    _, token = server.enrol()
    head = b"PUT /api/v1/items/template/slow HTTP/1.1\r\nHost: x\r\nContent-Length: 100000\r\nAuthorization: Bearer " + \
        token.encode() + b"\r\n\r\n"
    ends = {}

    def drip(name, source, first, piece):
        began = time.monotonic()
        try:
            with server.client(source).tls() as tls:
                tls.sendall(first)
                while time.monotonic() - began < 12:
                    tls.sendall(piece)
                    time.sleep(0.1)
        except OSError:
            pass
        ends[name] = time.monotonic() - began

    def silence(name, source, opener):
        began = time.monotonic()
        connection = opener(server.client(source))
        connection.settimeout(12)
        try:
            while connection.recv(100):
                pass
        except OSError:
            pass
        ends[name] = time.monotonic() - began

    def half_handshake(client):
        connection = client.raw()
        connection.sendall(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03")
        return connection

    threads = [threading.Thread(target=drip, args=arguments) for arguments in
               (("body", "127.0.7.1", head, b"a"), ("head", "127.0.7.2", b"GET /api/v1/health HTTP/1.1\r\n", b"A: b\r\n"))]
    threads += [threading.Thread(target=silence, args=arguments) for arguments in
                (("TCP only", "127.0.7.3", Client.raw), ("TLS only", "127.0.7.4", Client.tls),
                 ("half a handshake", "127.0.7.5", half_handshake))]
    for thread in threads:
        thread.start()
    time.sleep(1)
    server.must_answer()
    for thread in threads:
        thread.join()
    for name, seconds in ends.items():
        if seconds > 8:
            sys.exit(f"slow client, {name}: expected to be cut off within some seconds, found {seconds:.1f} s")
    server.must_log("is cut off")
    server.must_answer()
    # A stop does not wait for clients.
    held = [server.client("127.0.7.6").raw() for _ in range(3)] + [server.client("127.0.7.7").tls()]
    held[-1].sendall(head + b"beltpick")
    time.sleep(0.2)
    server.stop()


def request_rate(program, work):
    """More requests a minute than an address may: 429 with the time to wait."""
    server = Server(program, work / "rate", 10)
    one = b"GET /api/v1/health HTTP/1.1\r\nHost: x\r\n\r\n"
    answers = server.client("127.0.8.1").send(one * 39 + one.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n"))
    refused = answers.count(b"HTTP/1.1 429 ")
    if not 20 <= refused <= 30 or answers.count(b"Retry-After: ") != refused:
        sys.exit(f"40 requests where 10 a minute are allowed: {refused} refused")
    server.must_answer("127.0.8.2")
    server.must_log("429 TOO_MANY_REQUESTS")
    server.stop()


def nothing_secret(server, bench):
    """No token in the log or in the state folder, and nothing there for others to read."""
    text = server.log() + (server.state / "tokens.json").read_text()
    for name in ("one_time", "commissioner"):
        if bench[name] in text:
            sys.exit(f"the {name} token stands in clear text on the disk")
    for path in (server.state / "tokens.json", server.state / "tls" / "key.pem"):
        expect(f"mode of {path.name}", path.stat().st_mode & 0o777, 0o600)


def restart(program, server, bench):
    """Certificate, tokens and items are there again."""
    certificate = server.certificate.read_bytes()
    server.stop()
    again = Server(program, server.folder, 100000)
    expect("the certificate", again.certificate.read_bytes(), certificate)
    expect("the token", again.client("127.0.9.1", bench["commissioner"]).ask("GET", KNUCKLE).status, 200)
    again.stop()


def main():
    program, _, work = (pathlib.Path(argument) for argument in sys.argv[1:4])
    shutil.rmtree(work / "run", ignore_errors=True)
    work = work / "run"
    server = Server(program, work / "main", 100000)
    bench = dict(zip(("one_time", "commissioner"), server.enrol()))
    try:
        for test in (round_trip, one_connection, live_answers, tokens, wrong_tokens, malformed, malformed_tls,
                     many_connections, one_upload_at_a_time, many_at_once, nothing_secret):
            began = time.monotonic()
            test(server, bench)
            server.must_answer()
            print(f"{test.__name__}: as expected ({time.monotonic() - began:.1f} s)")
        restart(program, server, bench)
        for test in (slow_clients, request_rate):
            test(program, work)
            print(f"{test.__name__}: as expected")
    finally:
        server.process.kill()


main()
