"""beltpickd under a service manager of this script's own: Type=notify, watchdog, status, reload and stop.

    run_notify.py BIN WORK
"""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import time

WATCHDOG_S = 0.6
CONFIG = """[camera]
id = "127.0.12.254"
[trigger]
tty = "{run}/no-trigger"
[model]
calibration = "{run}/calibration.json"
recipes = ["{run}/recipe.json"]
[plc]
address = "127.0.0.1"
port = 0
[limits]
image_width = 64
image_height = 48
template_points = 1000
grid_cells = 10000
segments = 16
object_points = 200
"""


def listen(manager, until, patience_s=60):
    """All messages up to the first for which until() holds, with their times."""
    heard = []
    give_up = time.monotonic() + patience_s
    while time.monotonic() < give_up:
        manager.settimeout(max(0.01, give_up - time.monotonic()))
        try:
            message = manager.recv(4096).decode()
        except TimeoutError:
            break
        heard.append((time.monotonic(), message))
        if until(message):
            return heard
    sys.exit(f"not told within {patience_s} s; heard {[message for _, message in heard]}")


def threads_that_take(process, number):
    """The names of the process's threads that do not block the signal: it would end the process by default.

    The main thread is left out: while it waits for the signals, the kernel shows them as not blocked.
    """
    names = []
    for task in pathlib.Path(f"/proc/{process}/task").iterdir():
        if task.name == str(process):
            continue
        status = dict(line.split(":", 1) for line in (task / "status").read_text().splitlines())
        if not int(status["SigBlk"], 16) >> (number - 1) & 1:
            names.append(status["Name"].strip())
    return names


def main():
    bin_folder, run = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]) / "notify"
    shutil.rmtree(run, ignore_errors=True)
    run.mkdir(parents=True)
    (run / "beltpickd.toml").write_text(CONFIG.format(run=run))
    manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    name = f"\0beltpick-test-{os.getpid()}"  # abstract: paths of build folders may be too long
    manager.bind(name)
    environment = dict(os.environ, NOTIFY_SOCKET="@" + name[1:], WATCHDOG_USEC=str(int(WATCHDOG_S * 1e6)))
    with open(run / "beltpickd.log", "w") as log:
        daemon = subprocess.Popen([bin_folder / "beltpickd", "--config", run / "beltpickd.toml"], stderr=log,
                                  env=environment)
    try:
        listen(manager, lambda message: message == "READY=1")
        status = listen(manager, lambda message: message.startswith("STATUS=starting: "))[-1][1]
        if ": 107 TRIGGER_LOST: " not in status and ": 106 CAMERA_NOT_FOUND: " not in status:
            sys.exit(f"the status does not tell why the belt stands: {status}")
        beats = [listen(manager, lambda message: message == "WATCHDOG=1")[-1][0] for _ in range(6)]
        longest = max(after - before for before, after in zip(beats, beats[1:]))
        if longest > WATCHDOG_S:
            sys.exit(f"a sign of life came only after {longest:.2f} s, the watchdog waits for {WATCHDOG_S} s")
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            if taking := threads_that_take(daemon.pid, number):
                sys.exit(f"{number.name} may end the process by way of threads that do not block it: {taking}")
        daemon.send_signal(signal.SIGTERM)
        listen(manager, lambda message: message == "STOPPING=1")
        if daemon.wait(10) != 0:
            sys.exit(f"exit code on SIGTERM: {daemon.returncode}")
    finally:
        daemon.kill()
        daemon.wait()
    print(f"ready, '{status}', a sign of life every {longest:.2f} s at the longest, stopped")


main()
