# SPDX-License-Identifier: Apache-2.0
"""Session logs (MCAP), read and written by code of its own: the records, their checksums, the
reports in them. Source: "MCAP File Format Specification", mcap.dev/spec."""
import ctypes
import ctypes.util
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX = 1, 2, 3, 4, 5, 6, 7
ATTACHMENT, DATA_END = 9, 15
NOT_RECORDED = 6  # of condyle's events

_zstd = ctypes.CDLL(ctypes.util.find_library("zstd") or "libzstd.so.1")
_zstd.ZSTD_decompress.restype = ctypes.c_size_t
_zstd.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p,
                                  ctypes.c_size_t]


def decompress(data, size):
    out = ctypes.create_string_buffer(size)
    if _zstd.ZSTD_decompress(out, size, data, len(data)) != size:
        raise ValueError("a chunk cannot be uncompressed")
    return out.raw


def text(value):
    return struct.pack("<I", len(value)) + value


def take_text(data, at):
    size, = struct.unpack_from("<I", data, at)
    if at + 4 + size > len(data):
        raise ValueError("a text is cut")
    return data[at + 4:at + 4 + size], at + 4 + size


def records(data):
    """The whole records of a file or of a chunk: (opcode, content)."""
    at = len(MAGIC) if data.startswith(MAGIC) else 0
    while at + 9 <= len(data):
        opcode, size = struct.unpack_from("<BQ", data, at)
        if at + 9 + size > len(data) or (opcode == FOOTER and size != 20):
            return
        yield opcode, data[at + 9:at + 9 + size]
        at += 9 + size
        if opcode == FOOTER:
            return


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def chunk_content(content):
    size, crc = struct.unpack_from("<QI", content, 16)
    compression, at = take_text(content, 28)
    packed = content[at + 8:]
    plain = decompress(packed, size) if compression == b"zstd" else packed
    if crc and zlib.crc32(plain) != crc:
        raise ValueError("the checksum of a chunk is wrong")
    return plain


def pieces(data):
    """The data section, its chunks uncompressed: (opcode, content) with the content of a chunk as a
    list of records."""
    for opcode, content in records(data):
        if opcode == DATA_END:
            return
        if opcode == CHUNK:
            yield opcode, list(records(chunk_content(content)))
        elif opcode != MESSAGE_INDEX:
            yield opcode, content


def build(parts):
    """A file of such pieces, with all checksums right and without a summary."""
    out = bytearray(MAGIC)
    for opcode, content in parts:
        if opcode == CHUNK:
            plain = b"".join(record(*one) for one in content)
            content = (struct.pack("<QQQI", 0, 1, len(plain), zlib.crc32(plain)) + text(b"") +
                       struct.pack("<Q", len(plain)) + plain)
        elif opcode == ATTACHMENT and len(content) > 4:
            content = content[:-4] + struct.pack("<I", zlib.crc32(content[:-4]))
        out += record(opcode, content)
    out += record(DATA_END, struct.pack("<I", zlib.crc32(bytes(out))))
    out += record(FOOTER, struct.pack("<QQI", 0, 0, 0))
    return bytes(out) + MAGIC


class Log:
    """What a session log of condyle's fake facebow holds: its reports and their counters, how many
    it says are missing, and whether it is complete."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        self.is_complete = data.endswith(MAGIC) and len(data) > 2 * len(MAGIC)
        self.counters, self.reports, self.not_recorded = [], [], 0
        topics = {}
        for opcode, content in pieces(data):
            if opcode != CHUNK:
                continue
            for kind, one in content:
                if kind == CHANNEL:
                    topics[struct.unpack_from("<H", one)[0]] = take_text(one, 4)[0]
                elif kind == MESSAGE:
                    self._take(topics[struct.unpack_from("<H", one)[0]], one[22:])

    def _take(self, topic, message):
        if topic == b"/source_0/report":  # encoding, time, size; report id; its counter
            self.reports.append(message[16:])
            self.counters.append(struct.unpack_from("<I", message, 17)[0])
        elif topic == b"/source_0/event":
            kind, count = struct.unpack_from("<QQ", message, 12)
            if kind == NOT_RECORDED:
                self.not_recorded += count

    def missing(self):
        """Reports that are not between the first and the last one."""
        if not self.counters:
            return 0
        return self.counters[-1] - self.counters[0] + 1 - len(self.counters)
