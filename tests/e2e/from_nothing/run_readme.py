"""Runs the README's chapter "Install, configure over the network" line by line in an empty folder, and looks after each
of its steps whether it did what the text says. Only ports and the camera's address that somebody else has are replaced.

    run_readme.py SOURCE BIN WORK
"""

import json
import os
import pathlib
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import time

MARK = "<!-- tests/e2e/from_nothing runs these lines -->\n```bash\n"
PATIENCE_S = 120
END = ":end:of:step:"


def expect(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: expected {expected!r}, found {found!r}")


def steps(readme):
    """The block's paragraphs, in order."""
    if MARK not in readme:
        sys.exit("README.md: the block that this test runs is not there")
    block = readme.split(MARK, 1)[1].split("\n```", 1)[0]
    return [step for step in re.split(r"\n\n(?=#)", block) if step.strip()]


def port_is_free(port, kind, address="127.0.0.1"):
    with socket.socket(type=kind) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address, port))
            return True
        except OSError:
            return False


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return str(probe.getsockname()[1])


def replaced(text):
    """The script with what is taken on this machine replaced by what is free."""
    if not port_is_free(1502, socket.SOCK_STREAM):
        text = text.replace("1502", free_port())
    if not port_is_free(8443, socket.SOCK_STREAM):
        port = free_port()
        text = text.replace("--to localhost", f"--to localhost:{port}")
        text = text.replace("sed -i -e 's|^state", f"sed -i -e 's|^port = 8443 |port = {port} |' -e 's|^state", 1)
    if not port_is_free(3956, socket.SOCK_DGRAM):
        camera = next(f"127.0.9.{last}" for last in range(1, 250)
                      if port_is_free(3956, socket.SOCK_DGRAM, f"127.0.9.{last}"))
        text = text.replace('id = "127.0.0.1"', f'id = "{camera}"')
        text = text.replace("--trigger trigger", f"--trigger trigger --camera-address {camera}")
    return text


def prepare(source, bin_folder, work):
    """What a user has after the build: deploy/ and build/release/bin; and a home of their own."""
    shutil.rmtree(work, ignore_errors=True)
    (work / "build" / "release").mkdir(parents=True)
    (work / "deploy").symlink_to(source / "deploy")
    (work / "LICENSE").symlink_to(source / "LICENSE")
    (work / "build" / "release" / "bin").symlink_to(bin_folder)


class Shell:
    """One bash that reads the steps one after the other, as a person types them."""

    def __init__(self, work):
        self.log = open(work / "shell.log", "w+")
        environment = {**os.environ, "XDG_CONFIG_HOME": str(work / "config")}
        self.process = subprocess.Popen(["bash", "-e", "-u", "-o", "pipefail"], cwd=work, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=self.log, env=environment, start_new_session=True)

    def run(self, step):
        """What the step printed; ends the test where one of its commands fails or it does not end."""
        self.process.stdin.write(f"{step}\necho {END}\n".encode())
        self.process.stdin.flush()
        said, give_up = "", time.monotonic() + PATIENCE_S
        while not said.endswith(END + "\n"):
            if select.select([self.process.stdout], [], [], 0.2)[0]:
                piece = os.read(self.process.stdout.fileno(), 65536).decode()
                said += piece
                if piece:
                    continue
            if self.process.poll() is not None or time.monotonic() > give_up:
                sys.exit(f"this step failed or did not end:\n{step}\n--- it said\n{said}\n{self.errors()}")
        return said.removesuffix(END + "\n")

    def errors(self):
        self.log.seek(0)
        return self.log.read()[-3000:]

    def end(self):
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()


def state_of(work):
    return work / "try" / "tree" / "var" / "lib" / "beltpick"


def after_start(work, said):
    expect("the installed program", (work / "try/tree/usr/sbin/beltpickd").stat().st_mode & 0o777, 0o755)
    expect("mode of the one-time token", (state_of(work) / "one_time_token").stat().st_mode & 0o777, 0o600)


def after_enrolment(work, said):
    expect("the one-time token afterwards", (state_of(work) / "one_time_token").exists(), False)
    if "enrolled as commissioner" not in said:
        sys.exit(f"enrol said: {said}")


def after_uploads(work, said):
    for item in ("calibration", "cell", "template knuckle", "recipe knuckles"):
        if f"\n{item}: version 1 of " not in "\n" + said:
            sys.exit(f"uploads: expected '{item}: version 1 of ..' in:\n{said}")


def after_cycle(work, said):
    report = json.loads((work / "try/report.json").read_text())
    expect("belt finished", report["finished"], True)
    expect("crashes", report["crashes"], 0)
    if report["picked"] < 2:
        sys.exit(f"the cell: expected at least 2 of 4 parts picked, found {report['picked']}")
    if "failed" in said.split(", up ")[0]:
        sys.exit(f"doctor: expected no failed check in:\n{said}")
    if f"{report['picked']} picked" not in said:
        sys.exit(f"status: expected {report['picked']} picked in:\n{said}")


def after_rollback(work, said):
    versions = [line for line in said.splitlines() if re.match(r"[123] ", line)]
    expect("versions of the recipe", len(versions), 3)
    if "rollback to 1" not in versions[-1]:
        sys.exit(f"history: expected 'rollback to 1' in the last line of:\n{said}")


def after_end(work, said):
    tree = work / "try" / "tree"
    expect("files left", [str(path) for path in tree.rglob("*") if path.is_file()], [])
    if "is kept" not in said:
        sys.exit(f"uninstall: expected to be told that the state is kept, found:\n{said}")


LOOKS = [None, after_start, after_enrolment, after_uploads, after_cycle, after_rollback, after_end]


def main():
    source, bin_folder, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    script = steps(replaced((source / "README.md").read_text()))
    expect("steps of the README", len(script), len(LOOKS))
    prepare(source, bin_folder, work)
    shell = Shell(work)
    try:
        for step, look in zip(script, LOOKS):
            began = time.monotonic()
            if "--purge" in step:  # in two, to see that uninstalling keeps the state
                step, purge = step.rsplit("\n", 1)
                said = shell.run(step)
                expect("kept versions after uninstalling", len(list((state_of(work) / "recipe/knuckles").glob("*.item"))), 3)
                step, said = purge, said + shell.run(purge)
            else:
                said = shell.run(step)
            if look:
                look(work, said)
            print(f"{step.splitlines()[0][:70]}: {time.monotonic() - began:.1f} s", flush=True)
    finally:
        shell.end()


main()
