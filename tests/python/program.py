"""The program that the package is compared with."""

import json
import os
import subprocess

PROGRAM = os.environ["FETTLE_PROGRAM"]


def run(*arguments):
    """What a command reports with --json."""
    done = subprocess.run(
        [PROGRAM, *map(str, arguments), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False
    )
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.stderr.decode()}")
    report = json.loads(done.stdout)
    del report["schema"]  # of the text, not a figure
    return report


def hash_of(path):
    """The hash of what the program reads from a file: that of a filter that changes nothing."""
    return run("filter", path, str(path) + ".same.fettle", "--filter", "box", "--window", "1", "--force")["hash"]
