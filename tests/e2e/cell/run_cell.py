"""A short run of the whole cell: the real beltpickd beside the virtual cell, with faults or none.

    run_cell.py setup BIN WORK                    makes calibration, part and template once
    run_cell.py run BIN WORK --parts N [--fault NAME[@STOP]]... [--board emulated|host] [--seed S] [--picked LEAST]
                [--switch NAME --told TEXT]             breaks it after the first stop until beltpickd's log has TEXT
                [--sequence NAME] [--exposures-us A,B,..]   of the patterns command, in place of standard at one exposure

Fails unless the belt was finished, nothing crashed, nothing was unsafe, and each fault was answered by its own result
code and recovered from, and something was picked at the next stop.
"""

import argparse
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support" / "python"))
from daemon_config import cell_config  # noqa: E402
from free_places import free_camera_address, free_port  # noqa: E402

# A quarter of the product's pixels: the same job in a fraction of the time.
RIG = """camera_width = 640
camera_height = 480
"""
RECIPE = {
    "format": "beltpick-recipe", "version": 1, "number": 1, "name": "knuckles", "sequence": "sequence.json",
    "exposure_us": 8000, "settle_us": 1000, "period_us": 25000, "templates": ["knuckle.template"],
}


def setup(bin_folder, cell):
    shutil.rmtree(cell, ignore_errors=True)
    cell.mkdir(parents=True)
    beltpick = str(bin_folder / "beltpick")
    (cell / "rig.toml").write_text(RIG)
    subprocess.run([beltpick, "simulate", "--scene", "bare", "--rig", cell / "rig.toml", "--sequence", "standard",
                    "--out", cell / "rig", "--write-parts", cell, "--part", "knuckle"], check=True)
    for name in ("calibration.json", "cell.json", "sequence.json"):
        shutil.move(cell / "rig" / name, cell / name)
    subprocess.run([beltpick, "teach", cell / "knuckle.stl", "--grasps", cell / "knuckle.grasps.toml",
                    "--out", cell / "knuckle.template"], check=True)
    (cell / "recipe.json").write_text(json.dumps(RECIPE))


def start(command, log):
    return subprocess.Popen([str(word) for word in command], stdout=log, stderr=log)


def end(process):
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
    try:
        return process.wait(timeout=15)
    except subprocess.TimeoutExpired:
        process.kill()
        sys.exit("a process did not end on SIGTERM")


def other_sequence(bin_folder, cell, run, options):
    """The sequence of the options and its recipe, in `run`; those of the cell where none is asked for."""
    if not options.sequence:
        return cell / "sequence.json", cell / "recipe.json"
    command = [bin_folder / "beltpick", "patterns", "--projector", "912x1140", "--sequence", options.sequence,
               "--out", run / "patterns"]
    exposures = ["--exposures-us", options.exposures_us] if options.exposures_us else []
    subprocess.run([str(word) for word in command + exposures], check=True)
    recipe = RECIPE | {"sequence": options.sequence, "period_us": 0, "templates": [str(cell / "knuckle.template")]}
    if options.exposures_us:
        recipe["exposures_us"] = [float(each) for each in options.exposures_us.split(",")]
    (run / "recipe.json").write_text(json.dumps(recipe))
    return run / "patterns" / "sequence.json", run / "recipe.json"


def run_cell(bin_folder, cell, options):
    run = cell.parent / f"run-{options.board}-{options.fault[0] if options.fault else options.sequence or 'none'}"
    shutil.rmtree(run, ignore_errors=True)
    run.mkdir(parents=True)
    sequence, recipe = other_sequence(bin_folder, cell, run, options)
    camera, port = free_camera_address(8), free_port()
    (run / "beltpickd.toml").write_text(cell_config(
        cell, run, camera, port, trigger={"strobe_tolerance_us": 2000}, plc={"timeout_ms": 1500},
        model={"recipes": [str(recipe)]}, record={"summary": run / "summary.json"}))
    world_command = [bin_folder / "beltpick", "simulate", "--live", "--rig", cell / "rig.toml", "--part", "knuckle",
                     "--parts", options.parts, "--seed", options.seed, "--sequence", sequence,
                     "--plc", f"127.0.0.1:{port}", "--camera-address", camera, "--trigger", run / "trigger",
                     "--board", options.board, "--report", run / "report.json", "--speed", 5, "--linger", 30]
    if options.switch:
        world_command += ["--switches", run / "switches"]
    for fault in options.fault:
        world_command += ["--fault", fault]
    with open(run / "world.log", "w") as world_log, open(run / "beltpickd.log", "w") as daemon_log:
        world = start(world_command, world_log)
        try:
            wait_for(run / "trigger", world)
            daemon = start([bin_folder / "beltpickd", "--config", run / "beltpickd.toml"], daemon_log)
            try:
                if options.switch:
                    throw_switch(run, options)
                wait_for(run / "report.json", world, options.timeout)
            finally:
                stopped = end(daemon)
        finally:
            end(world)
    return run, stopped


def throw_switch(run, options):
    wait_for_text(run / "world.log", "stop  1:", options.timeout)
    (run / "switches").write_text(options.switch + "\n")
    wait_for_text(run / "beltpickd.log", options.told, options.timeout)
    (run / "switches").write_text("mend\n")


def wait_for_text(path, text, patience_s):
    give_up = time.monotonic() + patience_s
    while text not in path.read_text() and time.monotonic() < give_up:
        time.sleep(0.02)
    if text not in path.read_text():
        print(f"{path.name} never told {text}")


def wait_for(path, process, patience_s=30.0):
    give_up = time.monotonic() + patience_s
    while not path.exists() and process.poll() is None and time.monotonic() < give_up:
        time.sleep(0.05)
    if not path.exists():
        print(f"{path.name} did not appear in time")


def complaints(run, stopped, options):
    report, summary = read(run / "report.json"), read(run / "summary.json")
    if not report:
        return ["the virtual cell wrote no report"]
    found = []
    if not report["finished"]:
        found.append(f"not finished: {report.get('stopped_by')}")
    if stopped != 0:
        found.append(f"beltpickd ended with {stopped} on SIGTERM")
    for count in ("crashes", "unsafe"):
        if report[count]:
            found.append(f"{report[count]} {count}")
    if report["picked"] < options.picked:
        found.append(f"{report['picked']} picked of {report['parts']}, expected at least {options.picked}")
    if report["picked"] + report["tray"] != report["parts"]:
        found.append("parts were lost")
    if len(report["faults"]) != len(options.fault):
        found.append(f"{len(report['faults'])} faults were staged, expected {len(options.fault)}")
    for fault in report["faults"]:
        found += fault_complaints(fault, report["views"])
    if options.switch and options.told not in (run / "beltpickd.log").read_text():
        found.append(f"{options.switch}: beltpickd never told {options.told}")
    if not summary:
        found.append("beltpickd wrote no summary")
    return found


def fault_complaints(fault, views):
    found = []
    if not fault["answered"]:
        found.append(f"{fault['fault']}: expected {fault['expected']}, told {fault['codes']}")
    if not fault["recovered"]:
        found.append(f"{fault['fault']}: not recovered")
    # The stop after the faulty one: the next cycle works.
    after = fault["view"] + 1
    if after < len(views) and views[after]["picked"] == 0:
        found.append(f"{fault['fault']}: nothing was picked at the next stop")
    return found


def read(path):
    return json.loads(path.read_text()) if path.exists() else {}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["setup", "run"])
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--parts", type=int, default=3)
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--picked", type=int, default=1)
    parser.add_argument("--fault", action="append", default=[])
    parser.add_argument("--board", default="host")
    parser.add_argument("--switch", default="")
    parser.add_argument("--told", default="")
    parser.add_argument("--sequence", default="")
    parser.add_argument("--exposures-us", default="")
    parser.add_argument("--timeout", type=float, default=100)
    options = parser.parse_args()
    cell = options.work / "cell"
    if options.what == "setup":
        setup(options.bin, cell)
        return
    run, stopped = run_cell(options.bin, cell, options)
    found = complaints(run, stopped, options)
    print((run / "world.log").read_text())
    for complaint in found:
        print("FAILED:", complaint)
    if found:
        print((run / "beltpickd.log").read_text()[-6000:])
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
