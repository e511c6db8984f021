"""The commands of beltpick that talk to an appliance, with right and wrong input, against the real service with a
stand-in for the cell. What they tell is compared with the answers that Python's own HTTP and TLS get.

    run_link.py BIN SERVER CELL WORK      CELL: made by tests/e2e/cell/run_cell.py setup
"""

import json
import pathlib
import shutil
import socket
import sys
import threading

from bench import Impostor, User

from api_client import Server, expect

COMMANDS = [["status"], ["items"], ["items", "calibration"], ["download", "calibration", "--out", "/dev/null"],
            ["rollback", "calibration"], ["remove", "template", "knuckle"], ["tokens", "list"],
            ["tokens", "revoke", "anna"]]
NOWHERE = "no-such-host.invalid"


class Stage:
    def __init__(self, program, server_program, cell, work):
        shutil.rmtree(work, ignore_errors=True)
        self.work, self.cell, self.server_program = work, cell, server_program
        self.server = Server(server_program, work / "server")
        self.user = User(program, work / "anna")
        self.program = program
        self.to = f"127.0.0.1:{self.server.port}"
        self.token_file = self.server.state / "one_time_token"
        self.fingerprint = (self.server.state / "tls" / "fingerprint").read_text().strip()

    def python(self):
        """The same token, used by Python."""
        token = json.loads(self.user.kept(self.server.port).read_text())["token"]
        return self.server.client(token=token)

    def file(self, name, content):
        path = self.work / name
        path.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
        return path

    def versions(self, item):
        answer = self.python().ask("GET", f"/items/{item}/versions")
        return len(answer.json()["versions"]) if answer.status == 200 else 0


def not_enrolled(stage):
    for words in COMMANDS:
        stage.user.run(*words, "--to", stage.to, code=1, says="beltpick enrol --to " + stage.to)
    stage.user.run("status", "--to", NOWHERE, code=1, says="[NOT_ENROLLED]")
    for wrong in ("", "https://cell4", "cell4:0", "cell4:x", "a b"):
        stage.user.run("status", f"--to={wrong}", code=2, says="[USAGE]")


def enrolment(stage):
    user, to = stage.user, ("--to", stage.to)
    token = stage.token_file.read_text().strip()
    other = "sha256:" + "0" * 64
    user.run("enrol", *to, "--token", stage.token_file, "--fingerprint", other, code=1, says=stage.fingerprint)
    user.run("enrol", *to, "--token", stage.token_file, "--fingerprint", "sha256:12", code=2, says="64 hex digits")
    user.run("enrol", *to, "--token", stage.work / "missing", code=1, says="[FILE_NOT_FOUND]")
    user.run("enrol", *to, code=2, says="[USAGE]")
    user.run("enrol", *to, stdin="two words\n", code=2, says="[USAGE]")
    user.run("enrol", *to, stdin="wrong\n", code=1, says="[NOT_AUTHORIZED]")
    user.run("enrol", *to, "--name", "a/b", code=2, says="--name")
    user.run("enrol", "--to", "127.0.0.1:1", stdin="x", code=1, says="[SERVICE_UNREACHABLE]")
    nowhere = User(stage.program, stage.work / "nowhere")
    (nowhere.folder / "beltpick").write_text("a file where a folder should be")
    nowhere.run("enrol", *to, stdin=token + "\n", code=1, says="[FILE_NOT_WRITTEN]")
    expect("kept before", user.kept(stage.server.port).exists(), False)
    answer = user.json("enrol", *to, "--name", "anna", stdin=token + "\n", says="taken at first contact")
    expect("name and role", (answer["name"], answer["role"], answer["fingerprint"]),
           ("anna", "commissioner", stage.fingerprint))
    kept = user.kept(stage.server.port)
    expect("modes", (kept.stat().st_mode & 0o777, kept.parent.stat().st_mode & 0o777), (0o600, 0o700))
    user.run("enrol", *to, stdin=token + "\n", code=1, says="used already")
    expect("still known", json.loads(kept.read_text())["name"], "anna")


def at_a_terminal(stage):
    server = Server(stage.server_program, stage.work / "second")
    user, to = User(stage.program, stage.work / "berta"), ("--to", f"127.0.0.1:{server.port}")
    token = (server.state / "one_time_token").read_text().strip()
    key = (server.state / "tls" / "fingerprint").read_text().strip()
    screen = user.at_terminal("enrol", *to, answers=[("[y/N] ", "n")], code=1)
    if key not in screen or "not confirmed" not in screen:
        sys.exit(f"a refused key: {screen}")
    screen = user.at_terminal("enrol", *to, answers=[("[y/N] ", "yes"), ("token: ", token)])
    if "enrolled as commissioner" not in screen or token in screen:
        sys.exit(f"enrolment at a terminal: {screen}")
    server.stop()


def uploads(stage):
    user, to, cell = stage.user, ("--to", stage.to), stage.cell
    expect("nothing yet", user.json("items", *to), {"items": []})
    sent = user.json("upload", "calibration", cell / "calibration.json", *to)["uploads"]
    expect("first version", (sent[0]["version"], sent[0]["by"], sent[0]["origin"]), (1, "anna", "upload"))
    user.run("upload", "cell", cell / "cell.json", *to)
    user.run("upload", "template", cell / "knuckle.template", *to)
    dusty = json.loads((cell / "calibration.json").read_text()) | {"id": "dusty"}
    user.run("upload", "calibration", stage.file("dusty.json", dusty), *to, says="warning: calibration: it is dusty")
    user.run("upload", "template", cell / "knuckle.template", "--name", "other", *to, says="other beside knuckle: nothing differs")
    expect("the same again makes no version",
           user.json("upload", "template", cell / "knuckle.template", *to)["uploads"][0]["version"], 1)
    for item, file in (("template/knuckle", "knuckle.template"), ("cell/cell", "cell.json")):
        expect(f"bytes of {item}", stage.python().ask("GET", f"/items/{item}").body, (cell / file).read_bytes())


def recipes(stage):
    """What a recipe names by its path goes with it, or is there by its name."""
    user, to = stage.user, ("--to", stage.to)
    recipe = json.loads((stage.cell / "recipe.json").read_text())
    recipe["templates"] = ["parts/knuckle.template", "knuckle", "bracket"]
    shutil.copy(stage.cell / "sequence.json", stage.work)
    user.run("upload", "recipe", stage.file("knuckles.json", recipe), *to)
    taken = stage.python().ask("GET", "/items/recipe/knuckles").json()
    expect("templates", taken.pop("templates"), ["knuckle", "knuckle", "bracket"])
    expect("sequence", taken.pop("sequence"), json.loads((stage.cell / "sequence.json").read_text()))
    expect("everything else", taken, {name: recipe[name] for name in taken})
    plain = recipe | {"sequence": "standard", "templates": ["knuckle"]}
    file = stage.file("plain.json", plain)
    user.run("upload", "recipe", file, *to)
    expect("no path: the file as it is", stage.python().ask("GET", "/items/recipe/plain").body, file.read_bytes())
    lost = stage.file("lost.json", recipe | {"sequence": "not_there.json"})
    user.run("upload", "recipe", lost, *to, code=1, says="not_there.json")
    user.run("upload", "recipe", stage.file("none.json", recipe | {"templates": []}), *to, code=1, says="templates")
    broken = stage.file("broken.json", recipe | {"templates": ["knuckle", 7]})
    user.run("upload", "recipe", broken, *to, code=1, says="templates")


def wrong_uploads(stage):
    """Refused in one line, most before anything is sent; what the appliance itself refuses, in its words."""
    user, to = stage.user, ("--to", stage.to)
    before = stage.python().ask("GET", "/items").json()
    calibration = json.loads((stage.cell / "calibration.json").read_text())
    calibration["camera"]["matrix"][0][0] = -1
    template = (stage.cell / "knuckle.template").read_bytes()
    for kind, file, code in (("calibration", stage.file("minus.json", calibration), "[VALUE_OUT_OF_RANGE]"),
                             ("calibration", stage.file("empty.json", b""), "[FORMAT_INVALID]"),
                             ("cell", stage.cell / "calibration.json", "beltpick-cell"),
                             ("template", stage.cell / "recipe.json", "[FORMAT_INVALID]"),
                             ("template", stage.file("cut.template", template[:-9]), "["),
                             ("template", stage.file("flip.template", template[:-9] + b"x" + template[-8:]),
                              "[CHECKSUM_WRONG]"),
                             ("recipe", stage.cell / "cell.json", "beltpick-recipe"),
                             ("recipe", stage.work / "missing.json", "[FILE_NOT_FOUND]"),
                             ("cell", stage.work, "[FILE_UNREADABLE]"),
                             ("cell", stage.file("large.json", b" " * (1 << 17)), "[FILE_UNREADABLE]")):
        user.run("upload", kind, file, *to, code=1, says=code)
    for words in (["mesh", "x"], ["calibration"], ["calibration", "a", "b"], ["template", "a", "b", "--name", "c"],
                  ["calibration", stage.cell / "calibration.json", "--name", "x"],
                  ["template", stage.cell / "knuckle.template", "--name", "../x"]):
        user.run("upload", *words, *to, code=2, says="[USAGE]")
    spaced = stage.file("spaced.json", b" " + (stage.cell / "calibration.json").read_bytes())
    user.run("upload", "calibration", spaced, *to, code=1, says="expected a file that starts with {")  # the stand-in's
    good, bad = stage.cell / "knuckle.template", stage.work / "cut.template"
    user.run("upload", "template", good, bad, *to, code=1)
    expect("items afterwards", stage.python().ask("GET", "/items").json(), before)


def the_same_as_python(stage):
    user, to, python = stage.user, ("--to", stage.to), stage.python()
    expect("items", user.json("items", *to), python.ask("GET", "/items").json())
    expect("history", user.json("items", "calibration", *to),
           python.ask("GET", "/items/calibration/calibration/versions").json())
    expect("tokens", user.json("tokens", "list", *to), python.ask("GET", "/tokens").json())
    mine, theirs = user.json("status", *to), python.ask("GET", "/status").json()
    for changing in ("time", "uptime_s"):
        mine.pop(changing), theirs.pop(changing)
    expect("status", mine, theirs)
    for word in ("idle", "knuckles", "BP-1001", "NO_CALIBRATION", "commissioner"):
        if word not in user.run("status", *to):
            sys.exit(f"status: expected '{word}' in it")
    out = stage.work / "fetched"
    for item, words in (("calibration/calibration", ["calibration"]), ("template/knuckle", ["template", "knuckle"]),
                        ("calibration/calibration/versions/1", ["calibration", "--version", "1"])):
        user.run("download", *words, "--out", out, *to)
        expect(f"download of {item}", out.read_bytes(), python.ask("GET", f"/items/{item}").body)
    expect("version told", user.json("download", "calibration", "--out", out, *to)["version"], 2)


def history(stage):
    user, to = stage.user, ("--to", stage.to)
    expect("before", stage.versions("calibration/calibration"), 2)
    expect("back", user.json("rollback", "calibration", *to)["origin"], "rollback to 1")
    expect("back to one by number", user.json("rollback", "calibration", "--version", "2", *to)["version"], 4)
    user.run("rollback", "calibration", "--version", "77", *to, code=1, says="[FILE_NOT_FOUND]")
    user.run("rollback", "template", "nothing", *to, code=1, says="[FILE_NOT_FOUND]")
    user.run("rollback", "template", *to, code=2, says="[USAGE]")
    user.run("rollback", "calibration", "other", *to, code=2, says="[USAGE]")
    user.run("download", "template", "nothing", "--out", stage.work / "no", *to, code=1, says="[FILE_NOT_FOUND]")
    expect("nothing half-written", (stage.work / "no").exists(), False)
    user.run("download", "calibration", "--out", "/nonexistent/no", *to, code=1, says="[FILE_NOT_WRITTEN]")
    user.run("remove", "template", "other", *to)
    user.run("download", "template", "other", "--out", stage.work / "no", *to, code=1, says="[FILE_NOT_FOUND]")
    user.run("rollback", "template", "other", *to)
    user.run("upload", "template", stage.cell / "knuckle.template", "--name", "needed", *to)
    user.run("remove", "template", "needed", *to, code=2, says="expected no recipe to need it")
    user.run("remove", "calibration", *to, code=2, says="[USAGE]")


def roles(stage):
    to = ("--to", stage.to)
    token = stage.work / "token_of_otto"
    stage.user.run("tokens", "make", "otto", "--role", "viewer", "--out", token, *to)
    expect("mode of the token", token.stat().st_mode & 0o777, 0o600)
    stage.user.run("tokens", "make", "otto", "--out", token, *to, code=2, says="revoke it first")
    stage.user.run("tokens", "make", "otto", *to, code=2, says="--out")
    stage.user.run("tokens", "make", "lost", "--out", stage.cell / "recipe.json" / "x", *to, code=1,
                   says="[FILE_NOT_WRITTEN]")
    if "lost" in stage.user.run("tokens", "list", *to):
        sys.exit("a token that could not be written is still good")
    stage.user.run("tokens", "make", "o", "--role", "king", "--out", token, *to, code=2)
    otto = User(stage.program, stage.work / "otto")
    expect("role", otto.json("enrol", *to, "--access-token", token)["role"], "viewer")
    otto.run("status", *to)
    for words in (["upload", "cell", stage.cell / "cell.json"], ["rollback", "cell"], ["tokens", "list"]):
        otto.run(*words, *to, code=1, says="[ROLE_TOO_LOW]")
    expect("a viewer's self-test", verdicts(otto.json("doctor", *to))["self-test"], "skipped")
    stage.user.run("tokens", "revoke", "otto", *to)
    otto.run("status", *to, code=1, says="[NOT_AUTHORIZED]")
    report = otto.json("doctor", *to, code=1, says="first 'token'")
    expect("doctor with a revoked token", verdicts(report)["token"], "failed")
    stage.user.run("tokens", "revoke", "otto", *to, code=1, says="[FILE_NOT_FOUND]")
    stage.user.run("tokens", "revoke", *to, code=2, says="[USAGE]")


def permissions(stage):
    kept = stage.user.kept(stage.server.port)
    for mode in (0o644, 0o660):
        kept.chmod(mode)
        stage.user.run("status", "--to", stage.to, code=1, says="chmod 600")
    kept.chmod(0o600)
    kept.parent.chmod(0o777)
    stage.user.run("status", "--to", stage.to, code=1, says="chmod 700")
    kept.parent.chmod(0o700)
    stage.user.run("status", "--to", stage.to)


def other_hosts(stage):
    """Another host's certificate: nothing is sent to it, not by any command."""
    other = Server(stage.server_program, stage.work / "other")
    impostor = Impostor(other.state / "tls", b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}")
    to = f"127.0.0.1:{impostor.port}"
    shutil.copy(stage.user.kept(stage.server.port), stage.user.kept(impostor.port))
    for words in COMMANDS:
        stage.user.run(*words, "--to", to, code=1, says="[CERTIFICATE_CHANGED]")
    expect("sent to another host", impostor.got, b"")
    key = (other.state / "tls" / "fingerprint").read_text().strip()
    stage.user.run("status", "--to", to, code=1, says=key)
    stage.user.run("status", "--to", to, code=1, says=stage.fingerprint)
    stage.user.run("enrol", "--to", to, stdin="secret-token\n", code=1, says="[CERTIFICATE_CHANGED]")
    screen = stage.user.at_terminal("enrol", "--to", to, answers=[("[y/N] ", "")], code=1)
    if "has changed" not in screen or stage.fingerprint not in screen or key not in screen:
        sys.exit(f"a changed key at a terminal: {screen}")
    report = stage.user.json("doctor", "--to", to, code=1, says="first 'certificate'")
    expect("nothing is asked of another host", report["checks"][-1]["side"], "here")
    if b"secret" in impostor.got or b"Authorization" in impostor.got:
        sys.exit(f"a secret was sent to another host: {impostor.got}")
    impostor.close()
    other.stop()


def no_appliance(stage):
    """The right key, but answers that are none: refused in one line, redirects not followed."""
    for reply, code in ((b"HTTP/1.1 302 Found\r\nLocation: https://127.0.0.1:1/\r\nContent-Length: 0\r\n\r\n", "302"),
                        (b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nhello", "[FORMAT_INVALID]"),
                        (b"HTTP/1.1 200 OK\r\nContent-Length: 50\r\n\r\nhello", "[SERVICE_UNREACHABLE]"),
                        (b"", "[SERVICE_UNREACHABLE]"), (b"SSH-2.0-x\r\n", "[SERVICE_UNREACHABLE]"),
                        (b"HTTP/1.1 500 Oops\r\nContent-Length: 2\r\n\r\n[]", "HTTP status 500"),
                        (b"HTTP/1.1 429 No\r\nRetry-After: 9\r\nContent-Length: 0\r\n\r\n", "9 s")):
        impostor = Impostor(stage.server.state / "tls", reply)
        shutil.copy(stage.user.kept(stage.server.port), stage.user.kept(impostor.port))
        stage.user.run("status", "--to", f"127.0.0.1:{impostor.port}", code=1, says=code)
        impostor.close()
    empty = Impostor(stage.server.state / "tls", b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n[]")
    shutil.copy(stage.user.kept(stage.server.port), stage.user.kept(empty.port))
    for words in COMMANDS[:3]:
        stage.user.run(*words, "--to", f"127.0.0.1:{empty.port}")
    empty.close()


def verdicts(report):
    return {check["name"]: check["verdict"] for check in report["checks"]}


def greet(listener):
    """A server that speaks no TLS."""
    try:
        while True:
            with listener.accept()[0] as client:
                client.sendall(b"220 mail\r\n")
    except OSError:
        pass


def doctor(stage):
    report = stage.user.json("doctor", "--to", stage.to)
    expect("of a good one", {name: verdict for name, verdict in verdicts(report).items() if name != "camera"},
           dict.fromkeys(("enrolment", "name", "port", "certificate", "versions", "clock", "token"), "good"))
    expect("its own check", verdicts(report)["camera"], "warning")
    expect("in all", report["verdict"], "warning")
    stranger = User(stage.program, stage.work / "stranger")
    with socket.create_server(("127.0.0.1", 0)) as mute:
        closed = mute.getsockname()[1]
    plain = socket.create_server(("127.0.0.1", 0))
    threading.Thread(target=greet, args=(plain,), daemon=True).start()
    for to, failed in ((stage.to, "enrolment"), (NOWHERE, "name"), (f"127.0.0.1:{closed}", "port"),
                       (f"127.0.0.1:{plain.getsockname()[1]}", "service")):
        report = stranger.json("doctor", "--to", to, code=1, says="[CHECK_FAILED]")
        expect(f"doctor --to {to}", verdicts(report)[failed], "failed")
        for check in report["checks"]:
            if check["verdict"] == "failed" and not (check["cause"] and check["remedy"]):
                sys.exit(f"a failed check without cause or remedy: {check}")
    plain.close()
    stage.user.run("doctor", code=2)


def flooded(stage):
    """Last, because this address is locked out then."""
    kept = stage.user.kept(stage.server.port)
    known = json.loads(kept.read_text())
    kept.write_text(json.dumps(known | {"token": "x" * 43}))
    for _ in range(4):
        stage.user.run("status", "--to", stage.to, code=1)
    stage.user.run("status", "--to", stage.to, code=1, says="[TOO_MANY_REQUESTS]")
    stage.user.run("status", "--to", stage.to, code=1, says="wait ")


def main():
    bin_folder, server, cell, work = (pathlib.Path(argument) for argument in sys.argv[1:5])
    stage = Stage(bin_folder / "beltpick", server, cell, work / "run")
    for test in (not_enrolled, enrolment, at_a_terminal, uploads, recipes, wrong_uploads, the_same_as_python, history,
                 doctor, roles, permissions, other_hosts, no_appliance, flooded):
        test(stage)
        print(f"{test.__name__}: as expected", flush=True)
    stage.server.stop()


main()
