"""Uploads over HTTPS to a server that is killed with -9 at random and started anew: every acknowledged version must be
there, whole; of the one that was on its way the old or the new state; and nothing of the history may be lost.

    kill_uploads.py SERVER WORK [--uploads N] [--seed S] [--kill-within S]

SERVER is `beltpickd`, or `api_test_server`, which is the service without a cell behind it. By hand, for long:

    kill_uploads.py build/release/bin/beltpickd /tmp/torture --uploads 1000 --seed 1

Its last line is JSON.
"""

import argparse
import hashlib
import json
import math
import pathlib
import random
import shutil
import signal
import struct
import subprocess
import sys
import threading
import time
import zlib
from http.client import HTTPException

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support" / "python"))
from api_client import Client  # noqa: E402
from free_places import free_port  # noqa: E402

KEEP = 10
CONFIG = """[camera]
id = "127.0.10.99"
[trigger]
tty = "{work}/no-trigger"
[plc]
address = "127.0.0.1"
port = {plc}
[service]
state = "{work}/state"
port = {port}
requests_per_minute = 10000000
[limits]
image_width = 640
image_height = 480
"""
IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def lens(width, height):
    matrix = [[width, 0, width / 2], [0, width, height / 2], [0, 0, 1]]
    return {"width": width, "height": height, "matrix": matrix, "distortion": [0, 0, 0, 0, 0]}


def calibration(chance):
    return json.dumps({
        "format": "beltpick-calibration", "version": 1, "id": f"{chance.getrandbits(64):x}",
        "camera": lens(640, 480), "projector": lens(912, 1140),
        "projector_from_camera": {"rotation": IDENTITY, "translation": [200, 0, 0]},
        "quality": {"note": "x" * chance.choice([0, 100, 10_000, 60_000])}}).encode()


def cell(chance):
    belt = [[1, 0, 0, chance.random()], [0, -1, 0, 0], [0, 0, -1, 700], [0, 0, 0, 1]]
    return json.dumps({"format": "beltpick-cell", "version": 1, "belt_from_camera": belt}).encode()


def template(chance):
    """A ball, as `beltpick teach` would write it."""
    radius, count = chance.uniform(10, 20), chance.choice([1500, 3000])
    golden = math.pi * (3 - math.sqrt(5))
    normals = []
    for i in range(count):
        z = 1 - 2 * (i + 0.5) / count
        r = math.sqrt(1 - z * z)
        normals += [r * math.cos(golden * i), r * math.sin(golden * i), z]
    header = json.dumps({
        "format": "beltpick-template", "version": 1, "points": count, "spacing_mm": radius * math.sqrt(12 / count),
        "box_min_mm": [-radius] * 3, "box_max_mm": [radius] * 3, "primitives": [], "grasps": [],
        "symmetry": {"name": "none", "elements": [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]],
                     "revolution": False, "axis_point_mm": [0, 0, 0], "axis_direction": [0, 0, 1]}}).encode()
    points = struct.pack(f"<{6 * count}f", *(radius * n for n in normals), *normals)
    return b"beltpick-template 1 %08x %d\n" % (zlib.crc32(header + points), len(header)) + header + points


def recipe(chance):
    return json.dumps({"format": "beltpick-recipe", "version": 1, "number": 1, "name": "balls", "sequence": "standard",
                       "exposure_us": chance.uniform(5000, 9000), "templates": ["ball"]}).encode()


MAKERS = {"calibration": calibration, "cell": cell, "template": template, "recipe": recipe}


class Server:
    """The process under test."""

    def __init__(self, program, work):
        self.program, self.work = program, work
        self.is_daemon = program.name == "beltpickd"
        self.state = work / "state"
        self.port, self.process, self.token = free_port(), None, None
        (work / "beltpickd.toml").write_text(CONFIG.format(work=work, port=self.port, plc=free_port()))

    def launch(self):
        words = ["--config", self.work / "beltpickd.toml"] if self.is_daemon else [self.state, "10000000"]
        with open(self.work / "server.log", "a") as log:
            self.process = subprocess.Popen([self.program, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log)

    def wait_ready(self):
        if not self.is_daemon:
            self.port = int(self.process.stdout.readline())
        give_up = time.monotonic() + 60
        while True:
            try:
                return self.client().ask("GET", "/health")
            except OSError:
                if self.process.poll() is not None or time.monotonic() > give_up:
                    sys.exit(f"{self.program} does not serve; see {self.work}/server.log")
                time.sleep(0.02)

    def enrol(self):
        one_time = (self.state / "one_time_token").read_text().strip()
        self.token = self.client().ask("POST", "/enrol", {"token": one_time, "name": "anna"}).json()["token"]

    def client(self):
        return Client(self.port, self.state / "tls" / "certificate.pem", token=self.token, timeout=30)

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            pipe.close()


class Item:
    def __init__(self, kind, name):
        self.path = f"/items/{kind}/{name}"
        self.kind, self.name = kind, name
        self.versions = []  # (number, bytes) acknowledged, oldest first
        self.in_flight = None

    def make(self, chance):
        return MAKERS[self.kind](chance)

    def check(self, client):
        """What is wrong with this item, or nothing."""
        connection = client.connection()
        answer = client.ask("GET", self.path + "/versions", connection=connection)
        found = [entry["version"] for entry in answer.json()["versions"]] if answer.status == 200 else []
        if self.in_flight and found[-1:] == [self.in_flight[0]]:
            self.versions.append(self.in_flight)
        self.in_flight = None
        wanted = self.versions[-KEEP:]
        if found != [number for number, _ in wanted]:
            return f"{self.name}: expected versions {[number for number, _ in wanted]}, found {found}"
        for number, content in wanted:
            if client.ask("GET", f"{self.path}/versions/{number}", connection=connection).body != content:
                return f"{self.name}: version {number} is not whole"
        if wanted and client.ask("GET", self.path, connection=connection).body != wanted[-1][1]:
            return f"{self.name}: the current version is not the newest"
        return None


class Uploader(threading.Thread):
    """Uploads without pause until the server is gone."""

    def __init__(self, server, items, chance):
        super().__init__()
        self.server, self.items, self.chance = server, items, chance
        self.begun = self.acknowledged = 0
        self.trouble = None

    def run(self):
        try:
            client = self.server.client()
            connection = client.connection()
            while not self.trouble:
                self.upload(client, connection)
        except (OSError, HTTPException):
            pass  # killed

    def upload(self, client, connection):
        # A recipe can be taken once its template is there.
        item = self.chance.choice([item for item in self.items if item.kind != "recipe" or self.items[2].versions])
        content = item.make(self.chance)
        item.in_flight = (item.versions[-1][0] + 1 if item.versions else 1, content)
        self.begun += 1
        type_ = "application/octet-stream" if item.kind == "template" else "application/json"
        answer = client.ask("PUT", item.path, content, {"Content-Type": type_}, connection)
        if answer.status != 201 or answer.json()["sha256"] != hashlib.sha256(content).hexdigest():
            self.trouble = f"{item.name}: refused: {answer.status} {answer.body[:300]}"
        elif answer.json()["version"] != item.in_flight[0]:
            self.trouble = f"{item.name}: expected version {item.in_flight[0]}, found {answer.json()['version']}"
        item.versions.append(item.in_flight)
        item.in_flight = None
        self.acknowledged += 1


def torture(server, options):
    chance = random.Random(options.seed)
    items = [Item("calibration", "calibration"), Item("cell", "cell"), Item("template", "ball"), Item("recipe", "balls")]
    counts = {"uploads": 0, "acknowledged": 0, "kills": 0, "hit": 0, "came_new": 0, "violations": 0}
    server.launch()
    server.wait_ready()
    server.enrol()
    while counts["uploads"] < options.uploads:
        uploader = Uploader(server, items, chance)
        uploader.start()
        uploads = chance.randrange(8)
        while uploader.is_alive() and uploader.acknowledged < uploads:
            time.sleep(0.002)
        time.sleep(chance.uniform(0, options.kill_within))
        server.kill()
        uploader.join()
        if uploader.trouble:
            sys.exit(uploader.trouble)
        counts["kills"] += 1
        counts["uploads"] += uploader.begun
        counts["acknowledged"] += uploader.acknowledged
        interrupted = [item for item in items if item.in_flight]
        counts["hit"] += len(interrupted)
        if chance.random() < 0.1:  # killed while it starts, too
            server.launch()
            time.sleep(chance.uniform(0, 0.3))
            server.kill()
            counts["kills"] += 1
        server.launch()
        server.wait_ready()
        before = sum(len(item.versions) for item in items)
        for item in items:
            if trouble := item.check(server.client()):
                sys.exit(f"after {counts}: {trouble}")
        counts["came_new"] += sum(len(item.versions) for item in items) - before
    return counts


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("server", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--uploads", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kill-within", type=float, default=0.05, help="s, after a few uploads")
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    options.work.mkdir(parents=True)
    server = Server(options.server.resolve(), options.work.resolve())
    try:
        print(json.dumps(torture(server, options)))
    finally:
        if server.process and server.process.poll() is None:
            server.kill()


main()
