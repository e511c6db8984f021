"""The end of deploy/demo: what cell and appliance counted, as a table for people or one line of JSON.

    result.py RUN_FOLDER true|false
"""

import json
import pathlib
import sys


def read(path):
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return {}


def tray_reasons(report):
    reasons = {}
    for view in report.get("views", []):
        if view["left"]:
            reasons[view["reason"]] = reasons.get(view["reason"], 0) + view["left"]
    return reasons


def result_of(run):
    report, summary = read(run / "report.json"), read(run / "summary.json")
    result = {key: report.get(key, 0) for key in ("parts", "picked", "tray", "crashes", "cycles")}
    result["stage_ms"] = summary.get("stage_ms", {})
    result["rss_mb"] = summary.get("rss_mb", 0)
    result["pictures"] = str(run / "pictures")
    result["tray_reasons"] = tray_reasons(report)
    result["blocked_picks"] = report.get("blocked", 0)
    result["captures"] = summary.get("captures", 0)
    result["faults"] = report.get("faults", [])
    result["unsafe"] = report.get("unsafe", 0)
    result["finished"] = report.get("finished", False)
    return result


def table(result):
    reasons = ", ".join(f"{count} {reason}" for reason, count in result["tray_reasons"].items())
    rows = [
        ("parts", result["parts"]),
        ("picked", result["picked"]),
        ("tray", f"{result['tray']}" + (f" ({reasons})" if reasons else "")),
        ("crashes", result["crashes"]),
        ("picks with the way in blocked", result["blocked_picks"]),
        ("belt stops, captures", f"{result['cycles']}, {result['captures']}"),
    ]
    rows += [(f"{name} (median)", f"{time:.1f} ms") for name, time in result["stage_ms"].items()]
    rows += [("memory of beltpickd", f"{result['rss_mb']:.0f} MB"), ("pictures", result["pictures"])]
    for fault in result["faults"]:
        told = ", ".join(fault["codes"]) or "nothing"
        rows.append((f"fault {fault['fault']} at stop {fault['view'] + 1}",
                     f"told {told}; {'recovered' if fault['recovered'] else 'NOT recovered'}"))
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"  {name:<{width}}  {value}" for name, value in rows)


def main():
    run = pathlib.Path(sys.argv[1])
    result = result_of(run)
    print(json.dumps(result) if sys.argv[2] == "true" else table(result), flush=True)
    good = result["finished"] and result["crashes"] == 0 and result["unsafe"] == 0
    sys.exit(0 if good and all(fault["answered"] and fault["recovered"] for fault in result["faults"]) else 1)


if __name__ == "__main__":
    main()
