#!/usr/bin/env python3
"""Plants wrong lines and lists those that no test notices: see scripts/mutate."""

from __future__ import annotations

import argparse
import concurrent.futures
import json
import os
import pathlib
import sys

import equivalent
import places
import planting
import running

ROOMS = ("engine", "haptic", "render/plan", "render/detail")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/mutate", description=__doc__)
    parser.add_argument("--plants", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS))
    parser.add_argument("--seconds", type=float, default=180.0, help="of tests for one plant")
    parser.add_argument("--within", nargs="+", default=[""], help="build and try only the plants in these rooms")
    parser.add_argument("--see", nargs="*", default=["numeric"], help="folders of tests that look beyond their own room")
    parser.add_argument("--labels", nargs="*", default=[], help="labels of tests that are run too, as draws")
    parser.add_argument("--first", type=int, help="try only the first so many of the plants")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", type=int, nargs="+", help="try these plants again")
    parser.add_argument("--out", type=pathlib.Path, default=planting.ROOT / "build" / "mutate")
    return parser.parse_args()


def settings(options: argparse.Namespace) -> dict:
    """What a run that was cut goes on with: the plants are the same for these. Tests may have come since."""
    read = [*planting.sources(options.rooms), planting.HERE / "places.py"]
    return {"plants": options.plants, "seed": options.seed, "rooms": options.rooms,
            "sources": planting.run("git", "hash-object", *read, cwd=planting.ROOT).split()}


def mapped(folder: pathlib.Path, labels: list[str], out: pathlib.Path,
           pool: concurrent.futures.Executor) -> tuple[list[dict], set[str]]:
    """The tests and what each comes past; and the names of those that are new, or whose program is, since the last time."""
    path = out / "map.json"
    before = {t["name"]: t for t in json.loads(path.read_text())} if path.exists() else {}
    wanted = running.tests_of(folder, labels)
    known = [before[t["name"]] for t in wanted
             if t["name"] in before and before[t["name"]]["built"] == t["built"]]
    names = {t["name"] for t in known}
    groups = running.together([t for t in wanted if t["name"] not in names])
    new = [row for rows in pool.map(lambda group: running.mapped(group, out), groups) for row in rows]
    path.write_text(json.dumps(known + new))
    return known + new, {t["name"] for t in new}


def kept_results(path: pathlib.Path, options: argparse.Namespace, new: list[dict]) -> dict[int, dict]:
    """What was found before, but for plants that more is known about now: by new tests, or by more time."""
    if not path.exists():
        return {}
    reached = {n for test in new for n in test["reaches"]}
    results = {}
    for row in map(json.loads, path.read_text().splitlines()):
        number = row["number"]
        again = row["noticed"] is None and (
            number in reached or row["tests"] < row["of"] and row["seconds"] < options.seconds)
        if not again and number not in (options.only or []):
            results[number] = row
    return results


def main() -> int:
    options = arguments()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    state, results_path = out / "state.json", out / "results.jsonl"
    now = settings(options)
    if state.exists() and json.loads(state.read_text()) == now:
        plants = planting.planted_before(out)
    else:
        for path in (results_path, out / "map.json", state):
            path.unlink(missing_ok=True)
        plants = planting.plant(options, out)
        state.write_text(json.dumps(now))
    here = {n: p for n, p in plants.items() if p.file.startswith(tuple(options.within))}
    folder, refused = running.build(out, here, options.see, options.jobs)
    for n in refused:
        del plants[n], here[n]
    planting.keep(plants, out)
    print(f"{len(here)} of {len(plants)} plants built, {len(refused)} did not compile", flush=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        tests, new = mapped(folder, options.labels, out, pool)
        good = [t for t in tests if t["passes"]]
        print(f"{len(good)} of {len(tests)} tests pass without a plant; left out:",
              ", ".join(t["name"] for t in tests if not t["passes"]) or "none", flush=True)
        results = kept_results(results_path, options, [t for t in good if t["name"] in new])
        with results_path.open("w") as file:
            for row in results.values():
                file.write(json.dumps(row) + "\n")
            file.flush()
            waiting = [n for n in list(plants)[: options.first] if n in here and n not in results]
            futures = [pool.submit(running.tried, n, plants[n], good, options.seconds) for n in waiting]
            for future in concurrent.futures.as_completed(futures):
                row = future.result()
                results[row["number"]] = row
                file.write(json.dumps(row) + "\n")
                file.flush()
                if row["noticed"] is None:
                    p = plants[row["number"]]
                    print(f"not noticed: {row['number']}: {p.file}:{p.line}: {p.words()}",
                          f"({row['tests']} of {row['of']} tests)", flush=True)
    return report({n: p for n, p in plants.items() if n in results}, results)


def report(plants: dict[int, places.Place], results: dict[int, dict]) -> int:
    known = equivalent.read()
    unnoticed = [n for n in plants if results[n]["noticed"] is None]
    same = {n: known[key] for n in unnoticed if (key := equivalent.key(plants[n])) in known}
    rows: dict[str, list[int]] = {}
    for n, place in plants.items():
        row = rows.setdefault("/".join(place.file.split("/")[:2]), [0, 0, 0, 0])
        row[0] += 1
        row[1 if n not in unnoticed else 2 if n in same else 3] += 1
    print("\n| Room | planted | noticed | equivalent | survive |\n|---|---:|---:|---:|---:|")
    rows["all"] = [sum(column) for column in zip(*rows.values())]
    for room, row in [*sorted((r for r in rows.items() if r[0] != "all")), ("all", rows["all"])]:
        print(f"| {room} | " + " | ".join(map(str, row)) + " |")
    print()
    for n in unnoticed:
        place = plants[n]
        print(f"{n}: {place.file}:{place.line}: {place.words()}" + (f" -- equivalent: {same[n]}" if n in same else "")
              + ("" if results[n]["tests"] == results[n]["of"] else f" -- {results[n]['tests']} of {results[n]['of']} tests"))
    return 0 if rows["all"][1] >= 0.95 * len(plants) and len(same) <= 0.05 * len(plants) else 1


if __name__ == "__main__":
    sys.exit(main())
