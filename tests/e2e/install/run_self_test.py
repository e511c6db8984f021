"""beltpickd --self-test against the virtual cell: all good; then each thing wrong, named by its own check; then beside a
running beltpickd, which it must not disturb.

    run_self_test.py BIN CELL WORK      CELL: made by tests/e2e/cell/run_cell.py setup
"""

import json
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "service"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support" / "python"))
import api_client  # noqa: E402
from free_places import free_camera_address, free_port  # noqa: E402
from modbus_plc import expect  # noqa: E402
from waiting import wait_until  # noqa: E402

CONFIG = """[camera]
id = "{camera}"
[trigger]
tty = "{tty}"
[model]
calibration = "{calibration}"
cell = "{cell}/cell.json"
recipes = ["{recipe}"]
[projector]
kind = "{projector}"
device = "{projector_device}"
[plc]
address = "127.0.0.1"
port = {port}
[service]
state = "{state}"
port = {service_port}
[limits]
image_width = {width}
image_height = 480
"""
# What the machine that tests may lack, unlike an installed one.
MACHINE = {"clock", "memory lock", "real-time", "socket buffer", "packet size"}


class Bench:
    def __init__(self, bin_folder, cell, run):
        self.bin, self.run = bin_folder, run
        self.values = {"camera": free_camera_address(11), "tty": run / "trigger", "cell": cell, "port": free_port(),
                       "calibration": cell / "calibration.json", "state": run / "state", "service_port": free_port(),
                       "width": 640,
                       "recipe": cell / "recipe.json", "projector": "edge", "projector_device": ""}
        self.bright = run / "bright.json"
        self.bright.write_text(json.dumps({
            "format": "beltpick-recipe", "version": 1, "number": 1, "sequence": "fast", "exposure_us": 9000,
            "settle_us": 1000, "period_us": 25000, "templates": [str(cell / "knuckle.template")]}))
        self.world = subprocess.Popen(
            [bin_folder / "beltpick", "simulate", "--live", "--rig", cell / "rig.toml", "--part", "knuckle", "--parts", "1",
             "--sequence", cell / "sequence.json", "--plc", f"127.0.0.1:{free_port()}", "--camera-address",
             self.values["camera"], "--trigger", run / "trigger", "--wait", "300"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until("the virtual cell's trigger", (run / "trigger").exists, 30)

    def config(self, **changed):
        path = self.run / "beltpickd.toml"
        path.write_text(CONFIG.format(**(self.values | changed)))
        return path

    def self_test(self, **changed):
        """The exit code and every check by its name."""
        began = time.monotonic()
        done = subprocess.run([self.bin / "beltpickd", "--self-test", "--json", "--config", self.config(**changed)],
                              capture_output=True, text=True, timeout=30)
        if time.monotonic() - began > 15:
            sys.exit(f"the self-test with {changed} took {time.monotonic() - began:.1f} s")
        report = json.loads(done.stdout)
        expect("format", (report["format"], report["version"]), ("beltpick-self-test", 1))
        expect("exit code", done.returncode, 1 if report["worst"] == "failed" else 0)
        for check in report["checks"]:
            if check["verdict"] in ("warning", "failed") and not (check["cause"] and check["remedy"]):
                sys.exit(f"no cause or remedy: {check}")
        return {check["name"]: check for check in report["checks"]}

    def fails(self, name, said, **changed):
        checks = self.self_test(**changed)
        expect(f"verdict on the {name} with {changed}: {checks[name]}", checks[name]["verdict"], "failed")
        if said not in " ".join(checks[name].values()):
            sys.exit(f"{name}: expected '{said}', found {checks[name]}")
        others = {other for other, check in checks.items() if check["verdict"] == "failed"} - {name} - MACHINE
        return others


def all_good(bench):
    checks = bench.self_test()
    for name, check in checks.items():
        if check["verdict"] in ("failed", "warning") and name not in MACHINE:
            sys.exit(f"in a good cell: {check}")
    for name in ("camera", "image size", "exposure", "trigger box", "lines", "PLC port", "state folder", "models"):
        expect(f"verdict on the {name}: {checks[name]}", checks[name]["verdict"], "good")


def each_fault(bench):
    taken = socket.create_server(("127.0.0.1", 0))
    for name, said, changed in [
        ("camera", "does not answer", {"camera": "127.0.11.254"}),
        ("camera", "1000x480", {"width": 1000}),
        ("trigger box", "cannot be opened", {"tty": bench.run / "no-such-tty"}),
        ("trigger box", "expected a tty", {"tty": "/dev/null"}),
        ("PLC port", "is taken", {"port": taken.getsockname()[1]}),
        ("service", "is taken", {"service_port": taken.getsockname()[1]}),
        ("state folder", "/proc/beltpick", {"state": "/proc/beltpick"}),
    ]:
        # Another image size fits neither the sensor nor the calibration and what is loaded with it.
        expected = {"calibration", "models"} if "width" in changed else set()
        expect(f"failed besides the {name} with {changed}", bench.fails(name, said, **changed), expected)
    taken.close()
    # A projector that is to be asked; without a state folder, whose store would keep the first recipe.
    lightcrafter = {"projector": "lightcrafter4500", "recipe": bench.bright, "state": ""}
    for said, changed in [
        ("expected a LightCrafter 4500 on USB (0451:6401), found none", lightcrafter),
        ("/dev/hidraw-none", lightcrafter | {"projector_device": "/dev/hidraw-none"}),
        ("/dev/dri/none", lightcrafter | {"projector": "display", "projector_device": "/dev/dri/none"}),
    ]:
        expect(f"failed besides the projector with {changed}", bench.fails("projector", said, **changed), set())
    # Square patterns are no flash images of a diamond lattice: the recipe cannot be run, there is nothing to show.
    expect("failed besides the models", bench.fails("models", "diamond", projector="lightcrafter4500", state=""), set())


def no_calibration(bench):
    # With a fresh state folder: in the present one the store may have it already.
    others = bench.fails("calibration", "upload", calibration=bench.run / "none.json", state=bench.run / "fresh")
    expect("failed besides the calibration", others, {"models"})


def heartbeat(port):
    with socket.create_connection(("127.0.0.1", port), timeout=5) as plc:
        plc.sendall(bytes([0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 2]))
        answer = plc.recv(13, socket.MSG_WAITALL)
        return int.from_bytes(answer[9:11], "big"), int.from_bytes(answer[11:13], "big")


def beside_a_running_one(bench):
    with open(bench.run / "beltpickd.log", "w") as log:
        daemon = subprocess.Popen([bench.bin / "beltpickd", "--config", bench.config()], stderr=log)
    try:
        give_up = time.monotonic() + 20
        while time.monotonic() < give_up:
            try:
                if heartbeat(bench.values["port"])[1] == 1:
                    break
            except OSError:
                pass
            time.sleep(0.1)
        expect("state of the running one", heartbeat(bench.values["port"])[1], 1)
        checks = bench.self_test()
        for name in ("camera", "packet size", "trigger box", "lines"):
            expect(f"verdict on the {name}: {checks[name]}", checks[name]["verdict"], "skipped")
        expect(f"PLC port: {checks['PLC port']}", checks["PLC port"]["verdict"], "good")
        if "running beltpickd" not in checks["PLC port"]["found"]:
            sys.exit(f"the running beltpickd is not seen: {checks['PLC port']}")
        # Another beltpickd on the same devices, with another PLC port: it cannot have them.
        held = bench.self_test(port=free_port())
        for name in ("camera", "trigger box"):
            expect(f"verdict on the {name}: {held[name]}", held[name]["verdict"], "failed")
            if "another program" not in held[name]["cause"]:
                sys.exit(f"who holds it is not told: {held[name]}")
        expect("state of the running one afterwards", heartbeat(bench.values["port"])[1], 1)
        said = (bench.run / "beltpickd.log").read_text()
        if "LOST" in said.split("idle", 1)[-1]:
            sys.exit(f"the running beltpickd was disturbed:\n{said}")
    finally:
        daemon.send_signal(signal.SIGTERM)
        daemon.wait(10)


def over_https(bench):
    """The running one tests itself with the devices that it holds, and tells what has been lost."""
    with open(bench.run / "beltpickd.log", "w") as log:
        daemon = subprocess.Popen([bench.bin / "beltpickd", "--config", bench.config()], stderr=log)
    state = bench.run / "state"
    try:
        certificate, token = state / "tls" / "certificate.pem", state / "one_time_token"
        wait_until("a certificate and a one-time token", lambda: certificate.exists() and token.exists())
        client = api_client.Client(bench.values["service_port"], certificate, timeout=30)
        wait_until("the service", lambda: answers(client))
        enrolled = client.ask("POST", "/enrol", {"token": token.read_text().strip(), "name": "tester"})
        expect("status of enrolling", enrolled.status, 201)
        client.token = enrolled.json()["token"]

        def running():
            asked = client.ask("POST", "/self-test")
            expect("status of the self-test", asked.status, 200)
            return {check["name"]: check for check in asked.json()["checks"]}

        wait_until("camera and trigger box", lambda: running()["camera"]["verdict"] == "good" and
                   running()["trigger box"]["verdict"] == "good")
        checks = running()
        for name in ("camera", "image size", "trigger box", "lines", "state folder", "calibration", "models", "service"):
            expect(f"verdict of the running one on the {name}: {checks[name]}", checks[name]["verdict"], "good")
        expect(f"PLC port without a PLC: {checks['PLC port']}", checks["PLC port"]["verdict"], "warning")
        bench.world.kill()
        wait_until("the loss of both", lambda: running()["camera"]["verdict"] == "failed" and
                   running()["trigger box"]["verdict"] == "failed")
    finally:
        daemon.send_signal(signal.SIGTERM)
        daemon.wait(10)


def answers(client):
    try:
        return client.ask("GET", "/health").status == 200
    except OSError:
        return False


def main():
    bin_folder, cell, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    run = work / "self-test"
    shutil.rmtree(run, ignore_errors=True)
    run.mkdir(parents=True)
    bench = Bench(bin_folder, cell, run)
    try:
        for test in (all_good, each_fault, no_calibration, beside_a_running_one, over_https):
            test(bench)
            print(f"{test.__name__}: as expected")
    finally:
        bench.world.kill()
        bench.world.wait()


main()
