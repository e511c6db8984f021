"""The real beltpickd with a LightCrafter 4500 (a DLPC350 of our own behind a pseudo-terminal) beside the virtual cell:
everything that the projector does wrong stops the cell with its own result code, and the next cycle works after it is
mended.

    run_projector.py BIN GADGET CELL WORK      CELL: made by tests/e2e/cell/run_cell.py setup
"""

import json
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support" / "python"))
from daemon_config import cell_config  # noqa: E402
from free_places import free_camera_address, free_port  # noqa: E402
from waiting import wait_until  # noqa: E402

PARTS = 30
PATIENCE_S = 40
# What goes wrong, its result code, and words of the line that says what exactly.
FAULTS = [("refuse", "PROJECTOR_REFUSED", "refused command 0x"), ("silent", "PROJECTOR_SILENT", "expected a reply within"),
          ("other-reply", "PROJECTOR_WRONG_REPLY", "expected the reply"),
          ("fault", "PROJECTOR_FAULT", "it reports: sequencer error"), ("unplug", "PROJECTOR_LOST", "projector")]


def stops(log):
    return log.read_text().count("\nstop ")


def run(bin_folder, gadget, cell, work):
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    subprocess.run([bin_folder / "beltpick", "patterns", "--lcr4500", "--sequence", "fast", "--json", "--out", work / "fast"],
                   check=True, stdout=subprocess.DEVNULL)
    recipe = {"format": "beltpick-recipe", "version": 1, "number": 1, "sequence": "fast/sequence.json",
              "exposure_us": 9000, "settle_us": 1000, "period_us": 25000, "templates": [str(cell / "knuckle.template")]}
    (work / "recipe.json").write_text(json.dumps(recipe))
    camera, port = free_camera_address(14), free_port()
    (work / "beltpickd.toml").write_text(cell_config(
        cell, work, camera, port, trigger={"strobe_tolerance_us": 2000}, plc={"timeout_ms": 1500},
        model={"recipes": [str(work / "recipe.json")]},
        projector={"kind": "lightcrafter4500", "device": str(work / "projector")}))
    world_log, daemon_log = work / "world.log", work / "beltpickd.log"
    with open(world_log, "w") as out, open(daemon_log, "w") as daemon_out:
        projector = subprocess.Popen([gadget, work / "projector"], stdin=subprocess.PIPE, text=True)
        world = subprocess.Popen(
            [bin_folder / "beltpick", "simulate", "--live", "--rig", cell / "rig.toml", "--part", "knuckle", "--parts",
             str(PARTS), "--seed", "5", "--sequence", work / "fast/sequence.json", "--plc", f"127.0.0.1:{port}",
             "--camera-address", camera, "--trigger", work / "trigger", "--speed", "5", "--wait", "60"], stdout=out, stderr=out)
        daemon = None

        def tell(word):
            projector.stdin.write(word + "\n")
            projector.stdin.flush()

        try:
            wait_until("the trigger", (work / "trigger").exists, PATIENCE_S)
            daemon = subprocess.Popen([bin_folder / "beltpickd", "--config", work / "beltpickd.toml"], stderr=daemon_out)
            wait_until("the first stop", lambda: stops(world_log) >= 1, PATIENCE_S)
            for word, code, line in FAULTS:
                told = daemon_log.read_text().count(code)
                tell(word)
                wait_until(code, lambda: daemon_log.read_text().count(code) > told, PATIENCE_S)
                wait_until(f"a line with '{line}'", lambda: line in daemon_log.read_text(), PATIENCE_S)
                done = stops(world_log)
                tell("plug" if word == "unplug" else "well")
                wait_until(f"a stop after {code}", lambda: stops(world_log) > done, PATIENCE_S)
                print(f"{word}: {code}, and on it goes")
        finally:
            for process in (daemon, world, projector):
                if process:
                    process.terminate()
            ended = daemon.wait(timeout=15) if daemon else None
            world.wait(timeout=15)
            projector.wait(timeout=15)
            if sys.exc_info()[0]:
                print(world_log.read_text()[-2000:], daemon_log.read_text()[-4000:])
        if ended != 0:
            sys.exit(f"beltpickd ended with {ended} on SIGTERM")


run(*map(pathlib.Path, sys.argv[1:5]))
