"""Chooses the places of wrong lines and writes them into a copy of the source tree that compiles."""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import dataclasses
import hashlib
import itertools
import json
import pathlib
import re
import subprocess

import places

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


def find_all(files: list[str], arguments: dict[str, list[str]], out: pathlib.Path, jobs: int) -> list[places.Place]:
    """The places of all files; those of a file that has not changed are kept from before."""
    path = out / "places.json"
    kept = json.loads(path.read_text()) if path.exists() else {}
    rules = (HERE / "places.py").read_bytes()
    sums = {f: hashlib.sha256(rules + (ROOT / f).read_bytes()).hexdigest() for f in files}
    read = [f for f in files if kept.get(f, {}).get("sum") != sums[f]]
    with concurrent.futures.ProcessPoolExecutor(jobs) as pool:
        for file, some in zip(read, pool.map(found_in, read, [arguments[f] for f in read])):
            kept[file] = {"sum": sums[file], "places": [dataclasses.asdict(p) for p in some]}
    path.write_text(json.dumps(kept))
    return [places.Place(**row) for f in files for row in kept[f]["places"]]


def drawn(all_places: list[places.Place], seed: int) -> dict[str, list[places.Place]]:
    """The places of each kind in an order by chance, which depends on the seed and the places' own text alone: a change of
    the source leaves the plants where they were in all that it does not touch, and a list of survivors stays true."""
    by_kind: dict[str, list[tuple[str, places.Place]]] = {}
    seen: collections.Counter = collections.Counter()
    for place in all_places:
        what = (place.file, place.right, place.wrong)
        lot = hashlib.sha256(repr((seed, *what, seen[what])).encode()).hexdigest()
        seen[what] += 1
        by_kind.setdefault(place.kind, []).append((lot, place))
    return {kind: [place for _, place in sorted(some, key=lambda pair: pair[0])] for kind, some in by_kind.items()}


def chosen(all_places: list[places.Place], count: int, seed: int) -> list[places.Place]:
    """As many as asked for, no two of which overlap, every kind in turn."""
    by_kind = drawn(all_places, seed)
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


def put(path: pathlib.Path, text: bytes) -> None:
    """Leaves a file alone that has this text already, so that it is not compiled again."""
    if not path.exists() or path.read_bytes() != text:
        path.write_bytes(text)


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
        put(tree / f"{file}.planted", f'#pragma GCC system_header\n#line 1 "{tree / file}"\n'.encode() + text)
        put(tree / file, f'#include "{HERE / "planted.h"}"\n#include "{name}.planted"\n'.encode())


def refused(tree: pathlib.Path, plants: dict[int, places.Place], printed: str) -> list[int]:
    """The plants that a compiler's errors are about: those on the lines that it names."""
    lines: dict[str, set[int]] = {}
    for file, line in re.findall(rf"{re.escape(str(tree))}/(\S+?):(\d+):\d+:(?: error|   required from)", printed):
        lines.setdefault(file, set()).add(int(line))
    return [n for n, p in plants.items() if lines.get(p.file, set()) & lines_of(p)]


def lines_of(place: places.Place) -> set[int]:
    return set(range(place.line, place.line + place.right.count("\n") + 1))


def plant(options: argparse.Namespace, out: pathlib.Path) -> dict[int, places.Place]:
    """Chooses the plants; the same places for the same source and seed."""
    arguments = arguments_of(ROOT / "build" / "lint")
    files = [f for f in sources(options.rooms) if f in arguments]
    found = find_all(files, arguments, out, options.jobs)
    plants = numbered(chosen(found, options.plants, options.seed), planted_before(out))
    print(f"{len(found)} places in {len(files)} files, {len(plants)} chosen", flush=True)
    keep(plants, out)
    return plants


def numbered(chosen_places: list[places.Place], before: dict[int, places.Place]) -> dict[int, places.Place]:
    """The numbers that they had before, and those that are free for the others: a file whose plants are the same is not
    compiled again."""
    known = {place: number for number, place in before.items()}
    numbers = {known[place]: place for place in chosen_places if place in known}
    free = (number for number in itertools.count() if number not in numbers)
    return dict(sorted([*numbers.items(), *zip(free, (p for p in chosen_places if p not in known))]))


def grow(tree: pathlib.Path, plants: dict[int, places.Place]) -> None:
    """Makes the tree the source with these plants in it. What is the same keeps its time, so that it is not built again."""
    tree.mkdir(parents=True, exist_ok=True)
    planted = {f"{p.file}.planted" for p in plants.values()}
    for path in tree.rglob("*.planted"):
        if str(path.relative_to(tree)) not in planted:
            path.unlink()
    bring(tree, plants)
    write(tree, plants)


def bring(tree: pathlib.Path, plants: dict[int, places.Place]) -> None:
    """The source as it is now, also what is not committed, but for planted files."""
    planted = {p.file for p in plants.values()}
    for name in run("git", "ls-files", "-co", "--exclude-standard", cwd=ROOT).splitlines():
        if name not in planted and (ROOT / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            put(tree / name, (ROOT / name).read_bytes())
            (tree / name).chmod((ROOT / name).stat().st_mode)


def keep(plants: dict[int, places.Place], out: pathlib.Path) -> None:
    rows = {n: {"change": p.words(), **dataclasses.asdict(p)} for n, p in plants.items()}
    (out / "plants.json").write_text(json.dumps(rows, indent=1))


def planted_before(out: pathlib.Path) -> dict[int, places.Place]:
    path = out / "plants.json"
    rows = json.loads(path.read_text()) if path.exists() else {}
    return {int(n): places.Place(**{k: v for k, v in row.items() if k != "change"}) for n, row in rows.items()}
