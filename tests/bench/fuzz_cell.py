"""A live beltpickd beside the virtual cell, whose belt stands with parts in view: every cycle sees the same scene."""

import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import threading
import time

from api_client import Client
from daemon_config import cell_config
from free_places import free_port
from modbus_plc import Plc

START, END, CLEAR = 1, 5, 6
IDLE, OFFERING, RELEASED, FAULT = 1, 5, 6, 7


class Handover:
    """Lies between the virtual cell's PLC and beltpickd until parts lie in view; then the cell's PLC is cut off, its belt
    stands, and this program is the PLC."""

    def __init__(self, to_port):
        self.to_port, self.ends = to_port, []
        self.listener = socket.socket()
        self.listener.bind(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]

    def open(self):
        """Once beltpickd listens: until then the cell's PLC is refused as by beltpickd itself."""
        self.listener.listen()
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                here, _ = self.listener.accept()
            except OSError:
                continue
            try:
                there = socket.create_connection(("127.0.0.1", self.to_port), 5)
            except OSError:
                here.close()
                continue
            self.ends += [here, there]
            for source, sink in ((here, there), (there, here)):
                threading.Thread(target=self.forward, args=(source, sink), daemon=True).start()

    @staticmethod
    def forward(source, sink):
        try:
            while data := source.recv(4096):
                sink.sendall(data)
        except OSError:
            pass
        for end in (source, sink):
            end.close()

    def cut(self):
        self.to_port = 0
        for end in self.ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


class LiveCell:
    """beltpickd and the virtual cell, whose belt stands still: every cycle sees the same parts."""

    def __init__(self, bin_folder, cell, run):
        self.run, self.plc_port, self.service_port = run, free_port(), free_port()
        self.handover = Handover(self.plc_port)
        camera = f"127.{60 + os.getpid() % 60}.{os.getpid() // 60 % 250}.9"
        config = cell_config(
            cell, run, camera, self.plc_port, trigger={"strobe_tolerance_us": 2000}, plc={"timeout_ms": 60000},
            service={"state": run / "state", "port": self.service_port, "requests_per_minute": 10_000_000})
        (run / "beltpickd.toml").write_text(config)
        self.world = subprocess.Popen(
            [bin_folder / "beltpick", "simulate", "--live", "--rig", cell / "rig.toml", "--part", "knuckle", "--parts", "3",
             "--seed", "5", "--sequence", cell / "sequence.json", "--plc", f"127.0.0.1:{self.handover.port}", "--camera-address",
             camera, "--trigger", run / "trigger", "--linger", "36000"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.wait_for(run / "trigger")
        with open(run / "beltpickd.log", "w") as log:
            self.daemon = subprocess.Popen([bin_folder / "beltpickd", "--config", run / "beltpickd.toml"], stderr=log)
        self.wait_for(run / "state" / "tls" / "certificate.pem")
        self.wait_for(run / "state" / "one_time_token")
        self.handover.open()
        give_up = time.monotonic() + 180
        while "capturing -> processing" not in self.log():
            if time.monotonic() > give_up:
                sys.exit(f"no parts came into view; see {self.run}/beltpickd.log")
            time.sleep(0.02)
        self.handover.cut()

    def wait_for(self, path, patience_s=60):
        give_up = time.monotonic() + patience_s
        while not path.exists():
            if time.monotonic() > give_up:
                sys.exit(f"{path} did not appear; see {self.run}/beltpickd.log")
            time.sleep(0.05)

    def log(self):
        return (self.run / "beltpickd.log").read_text(errors="replace")

    def memory_mb(self):
        status = pathlib.Path(f"/proc/{self.daemon.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+)", status)[1]) / 1024

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.daemon.pid}/fd"))

    def client(self, token=None):
        return Client(self.service_port, self.run / "state" / "tls" / "certificate.pem", "127.0.0.1", token, 30)

    def enrol(self):
        token = (self.run / "state" / "one_time_token").read_text().strip()
        give_up = time.monotonic() + 20
        while True:
            try:
                return self.client().ask("POST", "/enrol", {"token": token, "name": "owner"}).json()["token"]
            except OSError:
                if time.monotonic() > give_up:
                    sys.exit("the service does not answer")
                time.sleep(0.1)

    def lift(self, steps):
        """Takes every thread of beltpickd and of the virtual cell as many steps of niceness above what else runs here; to
        one another they stay as they are."""
        for process in (self.daemon, self.world):
            for thread in os.listdir(f"/proc/{process.pid}/task"):
                os.setpriority(os.PRIO_PROCESS, int(thread), os.getpriority(os.PRIO_PROCESS, int(thread)) - steps)

    def stop(self):
        """The exit code of beltpickd on SIGTERM."""
        self.daemon.send_signal(signal.SIGTERM)
        try:
            return self.daemon.wait(30)
        except subprocess.TimeoutExpired:
            self.daemon.kill()
            return "hung"
        finally:
            self.world.kill()
            self.world.wait()


def run_cycles(port, stop, done):
    """The PLC: cycle after cycle over the belt that stands still."""
    plc = Plc(port)
    while not stop.is_set():
        state = plc.inputs()[1]
        if state == FAULT:
            plc.command(CLEAR)
        elif state in (IDLE, RELEASED):
            if plc.command(START) != 0:
                time.sleep(0.05)  # models are being swapped, or a fault waits
                continue
            plc.wait("a pose, or none", lambda inputs: inputs[1] in (OFFERING, RELEASED, FAULT, IDLE), 120)
            with done.get_lock():
                done.value += 1
        else:
            plc.command(END)
