"""What a linked program of 32 bits tells: its sections, and what its functions take."""

import struct
from pathlib import Path

# Of a section's head: offsets of the name, flags, where it is, its size, and the number of another one that belongs to it.
NAME, KIND, FLAGS, OFFSET, SIZE, LINK = 0, 1, 2, 4, 5, 6
SYMBOLS, NO_BITS = 2, 8
FUNCTION = 2


class ElfFile:
    def __init__(self, path):
        self.data = Path(path).read_bytes()
        offset, = struct.unpack_from("<I", self.data, 32)
        size, count, names = struct.unpack_from("<HHH", self.data, 46)
        self.heads = [struct.unpack_from("<10I", self.data, offset + size * nth) for nth in range(count)]
        self.names = self.heads[names][OFFSET]

    def text(self, at):
        return self.data[at : self.data.index(b"\0", at)].decode()

    def sections(self):
        """Name and head of each."""
        return [(self.text(self.names + head[NAME]), head) for head in self.heads]

    def functions(self):
        """Mangled name, address and size of each."""
        for _, head in self.sections():
            if head[KIND] != SYMBOLS:
                continue
            strings = self.heads[head[LINK]][OFFSET]
            for at in range(head[OFFSET], head[OFFSET] + head[SIZE], 16):
                name, address, size, info, _, _ = struct.unpack_from("<IIIBBH", self.data, at)
                if info & 15 == FUNCTION:
                    yield self.text(strings + name), address, size
