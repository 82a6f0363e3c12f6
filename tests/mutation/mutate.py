#!/usr/bin/env python3
"""Plants wrong lines and lists those that no test notices: see scripts/mutate."""

from __future__ import annotations

import argparse
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time

import places

ROOMS = ("engine", "haptic", "render/plan", "render/detail")
# Labels of tests that measure time, instructions or the window, or that build other things.
LEFT_OUT = {"instructions", "draws", "window", "live", "docs", "end_to_end"}
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def run(*command: object, **options: object) -> str:
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True, **options).stdout


def sources(rooms: list[str]) -> list[str]:
    """Where plants are looked for: the files of these rooms, but for headers."""
    return run("git", "ls-files", *(f"{room}/*.cpp" for room in rooms), cwd=ROOT).split()


def arguments_of(lint: pathlib.Path) -> dict[str, list[str]]:
    """What clang needs to read each file, from the folder of scripts/lint."""
    wanted = {}
    for row in json.loads((lint / "compile_commands.json").read_text()):
        words = row["command"].split()
        kept = [w for w in words if w.startswith(("-I", "-D", "-std"))]
        for name, value in zip(words, words[1:]):
            if name == "-isystem":
                kept += [name, value]
        wanted[str(pathlib.Path(row["file"]).resolve().relative_to(ROOT))] = kept
    return wanted


def found_in(file: str, arguments: list[str]) -> list[places.Place]:
    return places.Finder(str(ROOT / file), file, arguments).find()


def chosen(all_places: list[places.Place], count: int, seed: int) -> list[places.Place]:
    """As many as asked for, no two of which overlap, every kind in turn."""
    by_kind: dict[str, list[places.Place]] = {}
    for place in all_places:
        by_kind.setdefault(place.kind, []).append(place)
    dice = random.Random(seed)
    for kind in sorted(by_kind):
        dice.shuffle(by_kind[kind])
    taken: list[places.Place] = []
    used: dict[str, list[tuple[int, int]]] = {}
    while len(taken) < count and any(by_kind.values()):
        for kind in sorted(by_kind):
            while by_kind[kind]:
                place = by_kind[kind].pop()
                spans = used.setdefault(place.file, [])
                if all(place.end <= b or place.begin >= e for b, e in spans):
                    spans.append((place.begin, place.end))
                    taken.append(place)
                    break
    return taken[:count]


def write(tree: pathlib.Path, plants: dict[int, places.Place]) -> None:
    """Writes the files of the tree with these plants in them."""
    by_file: dict[str, list[int]] = {}
    for number, place in plants.items():
        by_file.setdefault(place.file, []).append(number)
    for file, numbers in by_file.items():
        text = (ROOT / file).read_bytes()
        for number in sorted(numbers, key=lambda n: -plants[n].begin):
            place = plants[number]
            text = text[: place.begin] + place.planted(number).encode() + text[place.end :]
        name = pathlib.Path(file).name
        # No warnings about what is planted, and the lines of the source. Files without a plant are as they were, so that the
        # compiler cache has them.
        (tree / f"{file}.planted").write_bytes(
            f'#pragma GCC system_header\n#line 1 "{tree / file}"\n'.encode() + text)
        (tree / file).write_text(f'#include "{HERE / "planted.h"}"\n#include "{name}.planted"\n')


def compiles(tree: pathlib.Path, file: str, arguments: list[str]) -> set[int]:
    """The lines of a planted file that do not compile."""
    kept = [a.replace(str(ROOT), str(tree)) if not a.startswith(f"-I{ROOT}/build") else a for a in arguments]
    done = subprocess.run(["c++", "-fsyntax-only", *kept, tree / file], stderr=subprocess.PIPE, text=True,
                          check=False)
    if done.returncode == 0:
        return set()
    lines = {int(m) for m in re.findall(rf"{re.escape(str(tree / file))}:(\d+):\d+: error", done.stderr)}
    lines |= {int(m) for m in re.findall(rf"{re.escape(str(tree / file))}:(\d+):\d+:   required from", done.stderr)}
    return lines or {-1}


def plant(options: argparse.Namespace, out: pathlib.Path) -> dict[int, places.Place]:
    """Chooses the plants and writes them into a copy of the source tree; the same for the same source and seed."""
    arguments = arguments_of(ROOT / "build" / "lint")
    files = [f for f in sources(options.rooms) if f in arguments]
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        found = [p for some in pool.map(found_in, files, [arguments[f] for f in files]) for p in some]
    print(f"{len(found)} places in {len(files)} files", flush=True)
    plants = dict(enumerate(chosen(found, options.plants, options.seed)))
    tree = out / "source"
    shutil.rmtree(tree, ignore_errors=True)
    tree.mkdir(parents=True)
    archive = subprocess.Popen(["git", "archive", "HEAD"], cwd=ROOT, stdout=subprocess.PIPE)
    run("tar", "-x", "-C", tree, stdin=archive.stdout)
    dropped = 0
    while True:
        write(tree, plants)
        planted = sorted({p.file for p in plants.values()})
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            bad = dict(zip(planted, pool.map(lambda f: compiles(tree, f, arguments[f]), planted)))
        wrong = [n for n, p in plants.items()
                 if bad[p.file] and (-1 in bad[p.file] or bad[p.file] & lines_of(p))]
        if not wrong:
            break
        for n in wrong:
            shutil.copy(ROOT / plants[n].file, tree / plants[n].file)  # if it was the only one
            del plants[n]
        dropped += len(wrong)
    print(f"{len(plants)} planted, {dropped} did not compile", flush=True)
    rows = {n: {"change": p.words(), **dataclasses.asdict(p)} for n, p in plants.items()}
    (out / "plants.json").write_text(json.dumps(rows, indent=1))
    return plants


def planted_before(out: pathlib.Path) -> dict[int, places.Place]:
    rows = json.loads((out / "plants.json").read_text())
    return {int(n): places.Place(**{k: v for k, v in row.items() if k != "change"}) for n, row in rows.items()}


def lines_of(place: places.Place) -> set[int]:
    return set(range(place.line, place.line + place.right.count("\n") + 1))


def build(out: pathlib.Path, jobs: int) -> pathlib.Path:
    """Builds the planted tree as a release, of which the compiler cache has what is not planted."""
    folder = out / "source" / "build" / "release"  # where it is in a checkout, whose objects the cache has
    run("cmake", "-S", out / "source", "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release")
    subprocess.run(["nice", "ninja", "-C", str(folder), f"-j{jobs}"], check=True, stdout=sys.stderr)
    return folder


def tests_of(folder: pathlib.Path) -> list[dict]:
    tests = []
    for row in json.loads(run("ctest", "--show-only=json-v1", cwd=folder))["tests"]:
        properties = {p["name"]: p["value"] for p in row.get("properties", [])}
        if LEFT_OUT & set(properties.get("LABELS", [])) or "command" not in row:
            continue
        command = [c for c in row["command"] if c != "--gtest_also_run_disabled_tests"]
        tests.append({"name": row["name"], "command": command, "folder": properties["WORKING_DIRECTORY"],
                      "environment": properties.get("ENVIRONMENT", [])})
    return tests


def passes(test: dict, limit: float, **variables: str) -> bool:
    environment = dict(os.environ, **variables)
    environment.update(e.split("=", 1) for e in test["environment"])
    with subprocess.Popen(test["command"], cwd=test["folder"], env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True) as process:
        try:
            return process.wait(limit) == 0
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            return False


def mapped(test: dict, number: int, out: pathlib.Path) -> dict:
    """The test without a plant at work: whether it passes, how long it takes, which plants it comes past."""
    path = out / f"map.{number}"
    path.unlink(missing_ok=True)
    begin = time.monotonic()
    good = passes(test, 300.0, FETTLE_PLANT_MAP=str(path))
    seconds = time.monotonic() - begin
    reached = sorted({int(line) for line in path.read_text().split()}) if path.exists() else []
    path.unlink(missing_ok=True)
    return {**test, "passes": good, "seconds": seconds, "reaches": reached}


def tried(number: int, place: places.Place, tests: list[dict], seconds: float) -> dict:
    """The tests that come past a plant, one after the other until one fails: those of its room first, quick ones first. A
    process that ends at once, as after a crash, leaves no map: where no test has it in its map, all of its room are run."""
    room = place.file.rsplit("/", 1)[0]
    near = [t for t in tests if number in t["reaches"]] or [t for t in tests if f"/tests/{room}/" in t["command"][0]]
    near.sort(key=lambda t: (f"/tests/{room}/" not in t["command"][0], t["seconds"]))
    begin = time.monotonic()
    for count, test in enumerate(near):
        if time.monotonic() - begin > seconds:
            return {"number": number, "noticed": None, "tests": count, "of": len(near)}
        if not passes(test, 10.0 * test["seconds"] + 20.0, FETTLE_PLANT=str(number)):
            return {"number": number, "noticed": test["name"], "tests": count + 1, "of": len(near)}
    return {"number": number, "noticed": None, "tests": len(near), "of": len(near)}


def equivalents() -> dict[tuple[str, str], str]:
    """(file, change) -> why no test can notice it."""
    known = {}
    for line in (HERE / "equivalent.txt").read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            file, change, why = (part.strip() for part in line.split(" | ", 2))
            known[file, change] = why
    return known


def main() -> int:
    parser = argparse.ArgumentParser(prog="scripts/mutate", description=__doc__)
    parser.add_argument("--plants", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="+", default=list(ROOMS))
    parser.add_argument("--seconds", type=float, default=180.0, help="of tests for one plant")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", type=int, nargs="+", help="try these plants again")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / "mutate")
    options = parser.parse_args()
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)

    # A run that was cut goes on where the settings and the source are the same.
    state = {"plants": options.plants, "seed": options.seed, "rooms": options.rooms,
             "source": run("git", "rev-parse", "HEAD", cwd=ROOT).strip()}
    kept, results_path, map_path = out / "state.json", out / "results.jsonl", out / "map.json"
    if kept.exists() and json.loads(kept.read_text()) == state:
        plants = planted_before(out)
    else:
        for path in (results_path, map_path, kept):
            path.unlink(missing_ok=True)
        plants = plant(options, out)
        kept.write_text(json.dumps(state))
    folder = build(out, options.jobs)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        if map_path.exists():
            tests = json.loads(map_path.read_text())
        else:
            wanted = tests_of(folder)
            tests = list(pool.map(mapped, wanted, range(len(wanted)), [out] * len(wanted)))
            map_path.write_text(json.dumps(tests))
        good = [t for t in tests if t["passes"]]
        print(f"{len(good)} of {len(tests)} tests pass without a plant; left out:",
              ", ".join(t["name"] for t in tests if not t["passes"]) or "none", flush=True)
        results = {}
        if results_path.exists():
            results = {r["number"]: r for r in map(json.loads, results_path.read_text().splitlines())}
        for number in options.only or []:
            results.pop(number, None)
        with results_path.open("w") as file:
            for row in results.values():
                file.write(json.dumps(row) + "\n")
            file.flush()
            waiting = [n for n in plants if n not in results]
            futures = [pool.submit(tried, n, plants[n], good, options.seconds) for n in waiting]
            for future in concurrent.futures.as_completed(futures):
                row = future.result()
                results[row["number"]] = row
                file.write(json.dumps(row) + "\n")
                file.flush()
                if row["noticed"] is None:
                    p = plants[row["number"]]
                    print(f"not noticed: {p.file}:{p.line}: {p.words()} ({row['tests']} of {row['of']} tests)", flush=True)
    return report(plants, results)


def report(plants: dict[int, places.Place], results: dict[int, dict]) -> int:
    known = equivalents()
    noticed = [n for n in plants if results[n]["noticed"] is not None]
    rest = [n for n in plants if results[n]["noticed"] is None]
    same = [n for n in rest if (plants[n].file, plants[n].words()) in known]
    print(f"\n{len(plants)} plants: {len(noticed)} noticed ({100.0 * len(noticed) / max(1, len(plants)):.1f} %), "
          f"{len(same)} equivalent, {len(rest) - len(same)} survive")
    for n in rest:
        place = plants[n]
        why = known.get((place.file, place.words()))
        print(f"{place.file}:{place.line}: {place.words()}" + (f" -- equivalent: {why}" if why else "")
              + ("" if results[n]["tests"] == results[n]["of"] else f" -- {results[n]['tests']} of {results[n]['of']} tests"))
    return 0 if len(noticed) >= 0.95 * len(plants) and len(same) <= 0.05 * len(plants) else 1


if __name__ == "__main__":
    sys.exit(main())
