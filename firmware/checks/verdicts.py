"""Checks that are told one by one as they are done."""

import time
from concurrent.futures import ThreadPoolExecutor


class Failure(Exception):
    pass


def expect(what, found, wanted):
    if found != wanted:
        raise Failure(f"{what}: {found!r} instead of {wanted!r}")


def within(what, found, wanted, allowed):
    if abs(found - wanted) > allowed:
        raise Failure(f"{what}: {found!r} instead of {wanted!r}, at most {allowed!r} apart")


def run_all(checks, threads=1):
    """Runs pairs of a name and a function that returns what it wants to tell; how many failed."""

    def run(check):
        name, function = check
        before = time.monotonic()
        try:
            verdict, told = "ok", function()
        except Failure as failure:
            verdict, told = "FAILED", str(failure)
        print(f"{verdict:6} {name} ({time.monotonic() - before:.1f} s){': ' if told else ''}{told or ''}", flush=True)
        return verdict == "FAILED"

    with ThreadPoolExecutor(threads) as pool:
        return sum(pool.map(run, checks))
