"""Builds the planted tree and runs the tests that come past a plant."""

from __future__ import annotations

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import places
from planting import grow, refused, run

# The tests of these are built and run where a plant is in them.
ROOMS = ("engine", "haptic", "render")
# Labels of tests that measure instructions or draw, need the window, build other things, or take an hour; --labels runs some.
LEFT_OUT = {"instructions", "draws", "window", "live", "docs", "end_to_end", "soak"}
# Tests below this are run many to a process, which is started once for them.
QUICK_S = 0.5


def build(out: pathlib.Path, plants: dict[int, places.Place], others: list[str], jobs: int) -> tuple[pathlib.Path, list[int]]:
    """Builds the source with these plants, and the tests of their rooms and of `others`; the compiler cache has what is not
    planted. Also says which plants do not compile, and are not in it."""
    tree = out / "source"
    folder = tree / "build" / "release"  # where it is in a checkout, whose objects the cache has
    planted = {p.file.split("/")[0] for p in plants.values()}
    wanted = [f"tests/{room}/all" for room in [*ROOMS, *others] if room in planted or room in others]
    command = ["ninja", "-C", str(folder), "-k", "0", f"-j{jobs}", *wanted]
    left, taken_out = dict(plants), []
    while True:
        grow(tree, left)
        run("cmake", "-S", tree, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
            "-DFETTLE_PLANTED=ON")
        printed = []
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as ninja:
            for line in ninja.stdout:
                sys.stderr.write(line)
                printed.append(line)
        if ninja.returncode == 0:
            return folder, taken_out
        wrong = refused(tree, left, "".join(printed))
        if not wrong:
            sys.exit("fettle: error: the planted tree does not compile, and no plant stands where the compiler says so")
        taken_out += wrong
        for n in wrong:
            del left[n]


def tests_of(folder: pathlib.Path, labels: list[str]) -> list[dict]:
    tests = []
    for row in json.loads(run("ctest", "--show-only=json-v1", cwd=folder))["tests"]:
        properties = {p["name"]: p["value"] for p in row.get("properties", [])}
        if (LEFT_OUT - set(labels)) & set(properties.get("LABELS", [])) or "command" not in row:
            continue
        command = [c for c in row["command"] if c != "--gtest_also_run_disabled_tests"]
        tests.append({"name": row["name"], "command": command, "folder": properties["WORKING_DIRECTORY"],
                      "environment": properties.get("ENVIRONMENT", []), "built": built(command[0])})
    return tests


def built(program: str) -> float:
    path = pathlib.Path(program)
    return path.stat().st_mtime if path.exists() else 0.0


def ended(command: list[str], test: dict, limit: float, **variables: str) -> tuple[bool, str]:
    """Whether a command ended well in time, and what it printed."""
    environment = dict(os.environ, **variables)
    environment.update(e.split("=", 1) for e in test["environment"])
    with tempfile.TemporaryFile("w+", errors="replace") as output, subprocess.Popen(
            command, cwd=test["folder"], env=environment, stdin=subprocess.DEVNULL, stdout=output,
            stderr=subprocess.DEVNULL, start_new_session=True) as process:
        try:
            good = process.wait(limit) == 0
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            good = False
        output.seek(0)
        return good, output.read()


def passes(test: dict, limit: float, **variables: str) -> bool:
    return ended(test["command"], test, limit, **variables)[0]


def process_of(test: dict) -> tuple:
    """What tests that can share a process have in common; none for what is no case of GoogleTest."""
    return (test["command"][0], test["folder"], tuple(test["environment"]), None if case_of(test) else test["name"])


def together(tests: list[dict]) -> list[list[dict]]:
    groups: dict[tuple, list[dict]] = {}
    for test in tests:
        groups.setdefault(process_of(test), []).append(test)
    return list(groups.values())


def command_of(batch: list[dict]) -> list[str]:
    """One process for all of these."""
    if len(batch) == 1:
        return batch[0]["command"]
    return [batch[0]["command"][0], "--gtest_filter=" + ":".join(case_of(t) for t in batch), "--gtest_fail_fast"]


def mapped(batch: list[dict], out: pathlib.Path) -> list[dict]:
    """The tests of a program without a plant at work: whether each passes, how long it takes, which plants it comes past."""
    with tempfile.NamedTemporaryFile("r", dir=out, prefix="map.") as file:
        begin = time.monotonic()
        command = [c for c in command_of(batch) if c != "--gtest_fail_fast"]
        good = ended(command, batch[0], 900.0, FETTLE_PLANT_MAP=file.name)[0]
        seconds = time.monotonic() - begin
        shared, since, cases = set(), set(), {}
        for line in file.read().splitlines():
            mark, *rest = line.split()
            if mark == "*":
                shared |= {int(n) for n in rest}
            elif mark == "-":
                since |= {int(n) for n in rest}
            elif mark == "=":
                cases[rest[0]] = (float(rest[1]) / 1000.0, rest[2] == "1", since | {int(n) for n in rest[3:]})
                since = set()
    rows = []
    for test in batch:
        if case_of(test) is None or len(batch) == 1 and not cases:
            rows.append({**test, "passes": good, "seconds": seconds, "reaches": sorted(since | shared)})
        elif case_of(test) in cases:
            took, passed, reached = cases[case_of(test)]
            rows.append({**test, "passes": passed, "seconds": took, "reaches": sorted(reached | shared)})
        else:  # the process ended before it
            rows += mapped([test], out) if len(batch) > 1 else [{**test, "passes": False, "seconds": 0.0, "reaches": []}]
    return rows


def limit_of(tests: list[dict]) -> float:
    return 10.0 * sum(t["seconds"] for t in tests) + 20.0


def case_of(test: dict) -> str | None:
    """The name that GoogleTest knows a test by."""
    found = [c.removeprefix("--gtest_filter=") for c in test["command"] if c.startswith("--gtest_filter=")]
    return found[0] if found else None


def batches(tests: list[dict], room: str) -> list[list[dict]]:
    """The tests in the order in which they are run: those of the plant's room first, quick ones before slow ones, all
    quick ones of a program in one process."""
    def own(test: dict) -> bool:
        return f"/tests/{room}/" in test["command"][0]

    quick = together([t for t in tests if t["seconds"] < QUICK_S])
    slow = [[t] for t in tests if t["seconds"] >= QUICK_S]
    return sorted([*quick, *slow], key=lambda some: (not own(some[0]), sum(t["seconds"] for t in some)))


def first_failed(batch: list[dict], limit: float, number: int) -> dict | None:
    """The first test of a process that fails with the plant at work; all of them, where the process does not say."""
    if len(batch) == 1:
        return None if passes(batch[0], limit, FETTLE_PLANT=str(number)) else batch[0]
    good, output = ended(command_of(batch), batch[0], limit, FETTLE_PLANT=str(number))
    if good:
        return None
    failed = (re.findall(r"^\[  FAILED  \] ([\w./]+)", output, re.M)
              or re.findall(r"^\[ RUN      \] ([\w./]+)", output, re.M)[-1:])
    return next((t for t in batch if failed and case_of(t) == failed[0]), batch[0])


def noticed(test: dict, number: int) -> bool:
    """Whether it is the plant that fails a test: alone it fails with it, and passes without it. What plays in real time may
    fail on a busy machine."""
    limit = limit_of([test])
    return not passes(test, limit, FETTLE_PLANT=str(number)) and passes(test, limit)


def tried(number: int, place: places.Place, tests: list[dict], seconds: float) -> dict:
    """Runs the tests that come past a plant until one fails. A process that ends at once, as after a crash, leaves no map:
    where no test has it in its map, all of its room are run."""
    room = place.file.rsplit("/", 1)[0]
    near = [t for t in tests if number in t["reaches"]] or [t for t in tests if f"/tests/{room}/" in t["command"][0]]
    # What a program computes once and keeps is passed by its first test alone.
    names, programs = {t["name"] for t in near}, {t["command"][0] for t in near}
    beside = [t for t in tests if t["name"] not in names and t["command"][0] in programs and t["seconds"] < QUICK_S]
    begin = time.monotonic()
    waiting, count = batches(near, room) + batches(beside, room), 0
    while waiting:
        if time.monotonic() - begin > seconds:
            break
        batch = waiting.pop(0)
        test = first_failed(batch, limit_of(batch), number)
        if test is not None and noticed(test, number):
            return {"number": number, "noticed": test["name"], "tests": count + 1, "of": len(near) + len(beside), "seconds": seconds}
        if test is not None and len(batch) > 1:
            waiting[:0] = [[t] for t in batch]  # each by itself, as it stands in no doubt then
            continue
        count += len(batch)
    return {"number": number, "noticed": None, "tests": count, "of": len(near) + len(beside), "seconds": seconds}
