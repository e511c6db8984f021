"""What beltpickd is told in the tests' small cell (made by tests/e2e/cell/run_cell.py setup)."""


def cell_config(cell, run, camera, plc_port, **more):
    """The text of beltpickd.toml. `more` adds to sections or overrides in them: plc={"timeout_ms": 1500}."""
    sections = {
        "camera": {"id": camera},
        "trigger": {"tty": run / "trigger"},
        "model": {"calibration": cell / "calibration.json", "cell": cell / "cell.json",
                  "recipes": [str(cell / "recipe.json")]},
        "plc": {"address": "127.0.0.1", "port": plc_port},
        "limits": {"image_width": 640, "image_height": 480},
    }
    for name, members in more.items():
        sections[name] = sections.get(name, {}) | members
    lines = []
    for name, members in sections.items():
        lines += [f"[{name}]"] + [f"{member} = {toml(value)}" for member, value in members.items()]
    return "\n".join(lines) + "\n"


def toml(value):
    if isinstance(value, list):
        return "[" + ", ".join(toml(each) for each in value) + "]"
    return str(value) if isinstance(value, int) else f'"{value}"'
