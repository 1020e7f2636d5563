#!/usr/bin/env python3
"""Shows that the core's pipeline, as it lies in a linked program, has no floating-point instruction and no
reachable panic.

usage: firmware/check-elf.py ELF

From every method's `push`, `miss`, `finish` and `start` it follows all direct calls. Not followed is the call
through the pointer that a method delivers its rows by: what lies behind it is not the core's.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = re.compile(r"(?:Pipeline|Sparse).*StereoMethod\S*::(push|miss|finish|start)::h")
PANIC = re.compile(r"core::panicking|core::cell::panic|_fail(::|$)|unwrap_failed|expect_failed")
HEAD = re.compile(r"^[0-9a-f]+ <(.*)>:$")
LINE = re.compile(r"^\s*([0-9a-f]+):\s+(\S+)(?:\s+(.*))?$")
TARGET = re.compile(r"<(.+?)(?:\+0x[0-9a-f]+)?>")


def objdump():
    """The disassembler of Rust's own tools, or one that is installed."""
    sysroot = subprocess.run(["rustc", "--print", "sysroot"], capture_output=True, text=True).stdout.strip()
    found = sorted(Path(sysroot).glob("lib/rustlib/*/bin/llvm-objdump"))
    tool = str(found[0]) if found else shutil.which("llvm-objdump")
    if tool is None:
        sys.exit("llvm-objdump is missing: rustup component add llvm-tools (Debian: apt install llvm)")
    return tool


def functions(elf):
    """Each function's calls, and its floating-point instructions."""
    command = [objdump(), "-d", "--no-show-raw-insn", "-C", elf]
    calls, floats, name = {}, {}, None
    for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
        if head := HEAD.match(line):
            name = head[1]
            calls.setdefault(name, set())
            floats.setdefault(name, [])
        elif name and (match := LINE.match(line)):
            _, instruction, operands = match.groups()
            # Every instruction of the floating-point unit begins with v.
            if instruction.startswith("v"):
                floats[name].append(line.strip())
            if instruction.startswith("b") and (target := TARGET.search(operands or "")) and target[1] != name:
                calls[name].add(target[1])
    return calls, floats


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    calls, floats = functions(sys.argv[1])
    roots = [name for name in calls if ROOT.search(name)]
    if len(roots) < 4:
        sys.exit(f"only {len(roots)} of the pipeline's functions are in {sys.argv[1]}: is it the twin?")
    came_from = dict.fromkeys(roots)
    todo = list(roots)
    while todo:
        name = todo.pop()
        for called in calls.get(name, ()):
            if called not in came_from:
                came_from[called] = name
                if not PANIC.search(called):
                    todo.append(called)
    wrong = 0
    for name in came_from:
        if PANIC.search(name):
            wrong += 1
            print(f"panic: {name}\n  called by {came_from[name]}")
        for instruction in floats.get(name, []):
            wrong += 1
            print(f"floating point in {name}: {instruction}")
    print(f"{len(roots)} functions of the pipeline reach {len(came_from)}: {wrong} floating-point instructions and panics")
    sys.exit(1 if wrong else 0)


main()
