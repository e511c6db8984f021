"""beltpickd from outside: command line and --check, a stop in the midst of a capture, a restart, a template larger than
the limits. The virtual cell gives camera and trigger; the PLC is this script.

    run_daemon.py BIN CELL WORK      CELL: made by tests/e2e/cell/run_cell.py setup
"""

import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support" / "python"))
from daemon_config import cell_config  # noqa: E402
from free_places import free_port  # noqa: E402
from modbus_plc import Plc, expect  # noqa: E402
from waiting import wait_until  # noqa: E402

START, END, CLEAR = 1, 5, 6
CAPTURING, RELEASED = 3, 6
RESTARTED, TEMPLATE_TOO_LARGE = 121, 25


class Bench:
    def __init__(self, bin_folder, cell, run):
        self.bin, self.cell, self.run = bin_folder, cell, run
        self.camera = "127.0.10.5"
        self.port = free_port()
        nobody = free_port()  # nobody will listen there: the cell's own PLC stays out of the way
        self.world = subprocess.Popen(
            [bin_folder / "beltpick", "simulate", "--live", "--rig", cell / "rig.toml", "--part", "knuckle", "--parts", "3",
             "--sequence", cell / "sequence.json", "--plc", f"127.0.0.1:{nobody}", "--camera-address", self.camera,
             "--trigger", run / "trigger", "--wait", "300"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until("the virtual cell's trigger", (run / "trigger").exists, 30)

    def config(self, points=40000):
        path = self.run / f"beltpickd-{points}.toml"
        path.write_text(cell_config(
            self.cell, self.run, self.camera, self.port, trigger={"strobe_tolerance_us": 2000},
            limits={"template_points": points}))
        return path

    def daemon(self, config):
        with open(self.run / "beltpickd.log", "a") as log:
            return subprocess.Popen([self.bin / "beltpickd", "--config", config], stderr=log)

    def check(self, *words):
        return subprocess.run([self.bin / "beltpickd", *words], capture_output=True, text=True, timeout=30)


def stop(daemon):
    began = time.monotonic()
    daemon.send_signal(signal.SIGTERM)
    expect("exit code on SIGTERM", daemon.wait(10), 0)
    if time.monotonic() - began > 2.0:
        sys.exit("the stop took longer than 2 s")


def command_line(bench):
    for words, code, said in [
        (["--help"], 0, "Example"),
        ([], 2, "--config"),
        (["--nonsense"], 2, "--nonsense"),
        (["--config", bench.run / "missing.toml"], 1, "missing.toml"),
        (["--config", bench.config(), "--check"], 0, "total"),
        (["--config", bench.config(1000), "--check"], 1, "TEMPLATE_TOO_LARGE"),
    ]:
        answer = bench.check(*words)
        expect(f"exit code of {words}", answer.returncode, code)
        if said not in answer.stdout + answer.stderr:
            sys.exit(f"{words}: expected '{said}' in the answer, found {answer.stdout!r} {answer.stderr!r}")
        if code != 0 and len(answer.stderr.splitlines()) > 3:
            sys.exit(f"{words}: more than a short message: {answer.stderr}")


def stop_while_capturing(bench):
    daemon = bench.daemon(bench.config())
    plc = Plc(bench.port)
    plc.wait("idle", lambda inputs: inputs[1] == 1)
    expect("start", plc.command(START), 0)
    plc.wait("capturing", lambda inputs: inputs[1] == CAPTURING)
    stop(daemon)


def restart(bench):
    daemon = bench.daemon(bench.config())
    plc = Plc(bench.port)
    inputs = plc.wait("idle", lambda inputs: inputs[1] == 1)
    expect("last code after a restart", inputs[6], RESTARTED)
    expect("belt and pose after a restart", inputs[2] & 0x18, 0)
    expect("clear", plc.command(CLEAR), 0)
    expect("start", plc.command(START), 0)
    inputs = plc.wait("belt released or a pose", lambda inputs: inputs[1] in (5, RELEASED))
    expect("end", plc.command(END), 0)
    expect("state after the end", plc.inputs()[1], RELEASED)
    stop(daemon)


def template_too_large(bench):
    daemon = bench.daemon(bench.config(1000))
    plc = Plc(bench.port)
    plc.wait("idle", lambda inputs: inputs[1] == 1)
    expect("start with a template larger than the limits", plc.command(START), TEMPLATE_TOO_LARGE)
    inputs = plc.inputs()
    expect("last code", inputs[6], TEMPLATE_TOO_LARGE)
    expect("belt and pose", inputs[2] & 0x18, 0)
    stop(daemon)


def main():
    bin_folder, cell, run = (pathlib.Path(argument) for argument in sys.argv[1:4])
    shutil.rmtree(run / "run", ignore_errors=True)
    run = run / "run"
    run.mkdir(parents=True)
    bench = Bench(bin_folder, cell, run)
    try:
        for test in (command_line, stop_while_capturing, restart, template_too_large):
            test(bench)
            print(f"{test.__name__}: as expected")
    finally:
        bench.world.kill()
        bench.world.wait()


main()
