"""Pictures of few colours, such as plots, made small: an indexed PNG instead of one of 24 bits."""

import collections
import struct
import zlib

COLORS = 64


def chunks(data):
    at = 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        yield kind, data[at + 8:at + 8 + length]
        at += 12 + length


def size(data):
    """Width and height."""
    return struct.unpack(">II", next(chunks(data))[1][:8])


def pixels(data):
    """Width, and the rows of a PNG of 8 bits a channel as lists of (red, green, blue)."""
    parts = list(chunks(data))
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", parts[0][1])
    if depth != 8 or kind not in (2, 6) or interlaced:
        raise ValueError("a PNG of 8 bits a channel, with or without alpha, is needed")
    size = 3 if kind == 2 else 4
    raw = zlib.decompress(b"".join(content for name, content in parts if name == b"IDAT"))
    stride, before, rows = width * size, bytes(width * size), []
    for y in range(height):
        filter_, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - size] if i >= size else 0
            up = before[i]
            if filter_ == 1:
                add = left
            elif filter_ == 2:
                add = up
            elif filter_ == 3:
                add = (left + up) // 2
            elif filter_ == 4:
                corner = before[i - size] if i >= size else 0
                p = left + up - corner
                add = min((left, up, corner), key=lambda x, p=p: abs(p - x))
            else:
                break
            line[i] = (line[i] + add) & 255
        before = bytes(line)
        rows.append([tuple(line[i:i + 3]) for i in range(0, stride, size)])
    return width, rows


def reduced(data):
    """The same picture in its most frequent colours; the others take the nearest of them."""
    width, rows = pixels(data)
    counts = collections.Counter(pixel for row in rows for pixel in row)
    coarse = {}  # of colours that look alike the most frequent one
    for color, count in counts.most_common():
        coarse.setdefault(tuple(channel >> 4 for channel in color), [color, 0])[1] += count
    palette = [color for color, _ in sorted(coarse.values(), key=lambda entry: -entry[1])[:COLORS]]
    index = {color: min(range(len(palette)), key=lambda i: sum((a - b)**2 for a, b in zip(color, palette[i])))
             for color in counts}
    raw = b"".join(b"\0" + bytes(index[pixel] for pixel in row) for row in rows)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, len(rows), 8, 3, 0, 0, 0)) +
            chunk(b"PLTE", b"".join(map(bytes, palette))) + chunk(b"IDAT", zlib.compress(raw, 9)) +
            chunk(b"IEND", b""))
