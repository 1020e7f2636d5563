#!/usr/bin/env python3
"""Shows that nothing in the application names a chip, a board, a sensor or a chip's library: `firmware/src/app` is the same on
every board.

usage: firmware/checks/app.py
"""

import re
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1] / "src"
# Every board and sensor that has a folder or a file, and what belongs to a chip.
BOARDS = [folder.name for folder in (SOURCE / "board").iterdir() if folder.is_dir()]
SENSORS = [file.stem for file in (SOURCE / "sensor").glob("*.rs") if "impl Sensor for" in file.read_text()]
WORDS = [*BOARDS, *SENSORS, "stm32", "embassy_stm32", "nucleo", "cortex_m", "dcmi", r"crate::board", r"\bpac\b"]
NAME = re.compile("|".join(WORDS), re.I)


def main():
    if len(BOARDS) < 1 or len(SENSORS) < 1 or len(sys.argv) > 1:
        sys.exit(__doc__.strip())
    files = sorted((SOURCE / "app").rglob("*.rs"))
    named = [f"{file.relative_to(SOURCE)}:{number}: {line.strip()}" for file in files
             for number, line in enumerate(file.read_text().splitlines(), 1) if NAME.search(line)]
    print(f"{len(files)} files of the application, {len(named)} lines that name a chip, a board or a sensor")
    print("\n".join(named))
    sys.exit(1 if named or not files else 0)


main()
