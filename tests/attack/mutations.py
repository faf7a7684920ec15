# SPDX-License-Identifier: Apache-2.0
"""Changes to texts and bytes of which parsers break."""
import struct

NUMBERS = [b"nan", b"-nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-320", b"1e999", b"-0", b"0",
           b"", b"1", b"-1", b"0x7f", b"1e300", b"1e5", b"-1e5", b"9223372036854775807",
           b"-9223372036854775808", b"18446744073709551616", b"4294967295", b"2147483648", b"65536",
           b"0.1.2", b"1,5", b"--1", b"1e", b"\xd9\xa1", b"1" * 400, b"0." + b"3" * 400, b"true"]
TOKENS = [b"\x00", b"\x1b[2J", b"\x1b]0;x\x07", b"\r", b"\n", b"\r\n", b"\t", b"\x7f", b"\xc2\x9b",
          b"\xe2\x80\xae", b"\xff\xfe", b"\xef\xbb\xbf", b"\xed\xa0\x80", b'"', b"'", b"\\", b"`",
          b",", b";", b"=", b"#", b"[", b"]", b"{", b"}", b"[[", b"]]", b"a.b.c=1\n", b"|", b"~",
          b"<", b">", b"<a>", b"</a>", b"<!--", b"-->", b"<![CDATA[", b"&amp;", b"&x;", b"&#0;",
          b"<!DOCTYPE a [<!ENTITY x 'y'>]>", b"%s%n", b"../../x", b"time_s", b"position_m", b"drive_N",
          b"p1_x_mm", b"=1+1", b"@SUM(1)", b"'''", b'"""', b"1979-05-27T07:32:00Z", b"mm", b"um"]
DIGITS = b"0123456789.+-eE"
EXTREMES = [0, 1, 2, 3, 7, 8, 127, 128, 255, 256, 32767, 32768, 65535, 65536, 2**31 - 1, 2**31,
            2**32 - 1, 2**32, 2**40, 2**63 - 1, 2**63, 2**64 - 1]


def flip(draw, data, _):
    at = draw.randrange(len(data))
    data[at] ^= 1 << draw.randrange(8)


def set_byte(draw, data, _):
    data[draw.randrange(len(data))] = draw.randrange(256)


def delete(draw, data, _):
    at = draw.randrange(len(data))
    del data[at:at + draw.choice((1, 1, 2, 4, 8, 64, len(data)))]


def double(draw, data, _):
    at = draw.randrange(len(data))
    piece = data[at:at + draw.choice((1, 4, 16, 64, 512))]
    data[at:at] = piece * draw.choice((1, 1, 2, 50))


def move(draw, data, _):
    a, b = draw.randrange(len(data)), draw.randrange(len(data))
    size = draw.choice((1, 4, 16, 64))
    piece = data[a:a + size]
    data[b:b + len(piece)] = piece


def splice(draw, data, others):
    other = draw.choice(others)
    if other:
        at, start = draw.randrange(len(data)), draw.randrange(len(other))
        data[at:] = other[start:]


def insert_token(draw, data, _):
    at = draw.randrange(len(data) + 1)
    data[at:at] = draw.choice(TOKENS)


def extreme_number(draw, data, _):
    """A number, in text."""
    at = draw.randrange(len(data))
    while at < len(data) and data[at] not in DIGITS:
        at += 1
    begin = end = at
    while begin > 0 and data[begin - 1] in DIGITS:
        begin -= 1
    while end < len(data) and data[end] in DIGITS:
        end += 1
    data[begin:end] = draw.choice(NUMBERS)


def extreme_field(draw, data, _):
    """A number of 1, 2, 4 or 8 bytes."""
    size = draw.choice((1, 2, 4, 8))
    at = draw.randrange(max(1, len(data) - size + 1))
    value = draw.choice(EXTREMES) % 2**(8 * size)
    data[at:at + size] = value.to_bytes(size, draw.choice(("little", "big")))


def lines(draw, data, _):
    rows = bytes(data).split(b"\n")
    kind, at = draw.randrange(4), draw.randrange(len(rows))
    if kind == 0:
        del rows[at]
    elif kind == 1:
        rows[at:at] = [rows[at]] * draw.choice((1, 2, 100))
    elif kind == 2:
        other = draw.randrange(len(rows))
        rows[at], rows[other] = rows[other], rows[at]
    else:
        cells = rows[at].split(b",")
        cell = draw.randrange(len(cells))
        if draw.random() < 0.5:
            cells[cell] = draw.choice(NUMBERS + TOKENS)
        else:
            cells[cell:cell] = [draw.choice(NUMBERS)]
        rows[at] = b",".join(cells)
    data[:] = b"\n".join(rows)


TEXT = [lines, lines, extreme_number, extreme_number, insert_token, double, delete, flip, set_byte,
        move, splice]
BYTES = [flip, set_byte, extreme_field, extreme_field, double, delete, move, splice, insert_token]


def mutate(draw, seed, others, is_text):
    """`seed` with one to six changes, of which splices take from `others`."""
    data = bytearray(seed)
    for _ in range(draw.choice((1, 1, 1, 2, 3, 6))):
        if not data:
            data = bytearray(draw.choice(others) or b"\n")
        draw.choice(TEXT if is_text else BYTES)(draw, data, others)
    return bytes(data)


def mutate_log(draw, parts):
    """A session log in pieces (mcap.py), one of which is changed; its checksums stay right."""
    from mcap import CHUNK, build, record, records
    parts = [(opcode, list(content) if opcode == CHUNK else content) for opcode, content in parts]
    for _ in range(draw.choice((1, 1, 2, 4))):
        at = draw.randrange(len(parts))
        opcode, content = parts[at]
        kind = draw.randrange(8)
        if kind == 0:
            del parts[at]
        elif kind == 1:
            parts.insert(draw.randrange(len(parts) + 1), parts[at])
        elif opcode == CHUNK:
            inner = draw.randrange(max(1, len(content)))
            if not content:
                continue
            if kind == 2:
                del content[inner]
            elif kind == 3:
                content.insert(draw.randrange(len(content) + 1), content[inner])
            else:
                number, one = content[inner]
                changed = mutate(draw, one, [one], False) if one else b"\x00"
                content[inner] = (draw.choice((number, number, number, draw.randrange(256))), changed)
        elif content:
            is_text = b"toml" in content[:64]
            parts[at] = (opcode, mutate(draw, content, [content], is_text))
        if not parts:
            break
    return build(parts)


def hostile_descriptor(draw):
    """A report descriptor of random items, with lengths that do not fit and large values."""
    out = bytearray()
    for _ in range(draw.randrange(1, 60)):
        size = draw.choice((0, 1, 1, 2, 4))
        tag = draw.choice((0x04, 0x08, 0x14, 0x18, 0x24, 0x34, 0x44, 0x54, 0x64, 0x74, 0x80, 0x84,
                           0x90, 0x94, 0xA0, 0xA4, 0xB0, 0xB4, 0xC0, 0xFC, draw.randrange(256)))
        out.append((tag & 0xFC) | (3 if size == 4 else size))
        value = draw.choice(EXTREMES) if draw.random() < 0.4 else draw.randrange(64)
        out += struct.pack("<Q", value)[:size]
    return bytes(out)
