#!/usr/bin/env python3
"""Shows that a linked program has a vector table, how much memory it takes, and that the core's pipeline in it has no
floating-point instruction and no reachable panic.

usage: firmware/checks/elf.py ELF [MOST_PANICS]
       firmware/checks/elf.py --sizes ELF...

With --sizes it only tells how much memory each takes.

MOST_PANICS (0 unless told) is how many kinds of panics may be reachable: each is a check of a bound that the compiler could
not prove.

From every method's `push`, `miss`, `finish` and `start` it follows all direct calls. Not followed is the call
through the pointer that a method delivers its rows by: what lies behind it is not the core's.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

from elf_file import FLAGS, KIND, NO_BITS, SIZE, ElfFile

ROOT = re.compile(r"(?:Pipeline|Sparse|Tiled).*StereoMethod\S*::(push|miss|finish|start)::h")
PANIC = re.compile(r"core::panicking|core::cell::panic|_fail(::|$)|unwrap_failed|expect_failed")
HEAD = re.compile(r"^[0-9a-f]+ <(.*)>:$")
LINE = re.compile(r"^\s*([0-9a-f]+):\s+(\S+)(?:\s+(.*))?$")
TARGET = re.compile(r"<(.+?)(?:\+0x[0-9a-f]+)?>")
# What the linker fills up with behind a function, 0xd4d4, reads as this branch; into another function none leads so near.
FILL = re.compile(r"imm = #-0x58$")


def sections(elf):
    """Sizes of the sections that take memory, by name, and whether they lie in flash or RAM or both."""
    # SHF_ALLOC; what is no SHT_NOBITS and may be written is copied from flash to RAM.
    return {name: (head[SIZE], head[KIND] != NO_BITS, bool(head[FLAGS] & 1))
            for name, head in ElfFile(elf).sections() if head[FLAGS] & 2 and head[SIZE]}


def memory(elf):
    found = sections(elf)
    if found.get(".vector_table", (0,))[0] < 64:
        sys.exit(f"{elf} has no vector table: the linker script did not reach the linker")
    flash = sum(size for size, is_stored, _ in found.values() if is_stored)
    ram = sum(size for size, _, is_written in found.values() if is_written)
    print(f"{Path(elf).name}: flash {flash} B, RAM {ram} B without the stack: {', '.join(f'{n} {s[0]}' for n, s in found.items())}")


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
    # The DSP extension is an option of Armv8-M that the file does not tell of.
    command = [objdump(), "-d", "--no-show-raw-insn", "--mattr=+dsp", "-C", elf]
    calls, floats, name = {}, {}, None
    for line in subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines():
        if head := HEAD.match(line):
            name = head[1]
            if name.startswith("$"):
                sys.exit(f"{command[0]} is too old, it takes {name} for a function: rustup component add llvm-tools")
            calls.setdefault(name, set())
            floats.setdefault(name, [])
        elif name and (match := LINE.match(line)):
            _, instruction, operands = match.groups()
            # Every instruction of the floating-point unit begins with v.
            if instruction.startswith("v"):
                floats[name].append(line.strip())
            if instruction == "bmi" and FILL.search(operands or ""):
                continue
            if instruction.startswith("b") and (target := TARGET.search(operands or "")) and target[1] != name:
                calls[name].add(target[1])
    return calls, floats


def main():
    if sys.argv[1:2] == ["--sizes"] and len(sys.argv) > 2:
        return [memory(elf) for elf in sys.argv[2:]]
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__.strip())
    most = int(sys.argv[2]) if len(sys.argv) == 3 else 0
    memory(sys.argv[1])
    calls, floats = functions(sys.argv[1])
    roots = [name for name in calls if ROOT.search(name)]
    if len(roots) < 4:
        sys.exit(f"only {len(roots)} of the pipeline's functions are in {sys.argv[1]}: is it one of ours?")
    came_from = dict.fromkeys(roots)
    todo = list(roots)
    while todo:
        name = todo.pop()
        for called in calls.get(name, ()):
            if called not in came_from:
                came_from[called] = name
                if not PANIC.search(called):
                    todo.append(called)
    wrong, panics = 0, 0
    for name in came_from:
        if PANIC.search(name):
            panics += 1
            print(f"panic: {name}\n  called by {came_from[name]}")
        for instruction in floats.get(name, []):
            wrong += 1
            print(f"floating point in {name}: {instruction}")
    print(f"{len(roots)} functions of the pipeline reach {len(came_from)}: {wrong} floating-point instructions, {panics} kinds of panics")
    sys.exit(1 if wrong or panics > most else 0)


main()
