"""A user with a folder of their own, running beltpick against a server; and servers that are no appliance."""

import json
import os
import pathlib
import pty
import select
import socket
import ssl
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "service"))

from api_client import expect  # noqa: E402


class User:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.environment = {**os.environ, "XDG_CONFIG_HOME": str(self.folder), "HOME": "/nonexistent"}

    def command(self, words):
        return [str(word) for word in (self.program, *words)]

    def run(self, *words, code=0, says="", stdin=""):
        """stdout of `beltpick WORDS`; ends the test unless it ends with `code` and says `says`, refusals in one line."""
        done = subprocess.run(self.command(words), env=self.environment, input=stdin, capture_output=True, text=True,
                              timeout=60)
        said = f"{' '.join(map(str, words))}: {done.stderr.strip()}"
        expect(f"exit code of {said}", done.returncode, code)
        if code != 0:
            refusals = [line for line in done.stderr.splitlines() if "warning:" not in line]
            expect(f"lines of refusal of {said}", len(refusals), 1)
        if says not in done.stderr:
            sys.exit(f"{said}: expected it to say '{says}'")
        return done.stdout

    def json(self, *words, **options):
        return json.loads(self.run(*words, "--json", **options))

    def at_terminal(self, *words, answers=(), code=0):
        """The screen of `beltpick WORDS` at a terminal, where each prompt of `answers` is answered."""
        process, terminal = pty.fork()
        if process == 0:
            os.execve(self.program, self.command(words), self.environment)
        screen, waiting = "", list(answers)
        give_up = time.monotonic() + 30
        while time.monotonic() < give_up:
            if select.select([terminal], [], [], 0.1)[0]:
                try:
                    piece = os.read(terminal, 4096).decode()
                except OSError:
                    break
                if not piece:
                    break
                screen += piece
            if waiting and screen.endswith(waiting[0][0]):
                time.sleep(0.2)  # the terminal's echo is off by then
                os.write(terminal, (waiting.pop(0)[1] + "\n").encode())
        expect(f"exit code at a terminal of {words}: {screen}", os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), code)
        os.close(terminal)
        return screen

    def kept(self, port, host="127.0.0.1"):
        return self.folder / "beltpick" / "appliances" / f"{host}_{port}.json"


class Impostor:
    """A TLS server that is no appliance: notes what it is sent, answers `reply`."""

    def __init__(self, tls_folder, reply=b""):
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        self.context.load_cert_chain(tls_folder / "certificate.pem", tls_folder / "key.pem")
        self.reply, self.got = reply, b""
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            try:
                with self.context.wrap_socket(self.listener.accept()[0], server_side=True) as client:
                    client.settimeout(2)
                    self.got += client.recv(65536)
                    client.sendall(self.reply)
            except OSError:
                if self.listener.fileno() < 0:
                    return

    def close(self):
        self.listener.close()
