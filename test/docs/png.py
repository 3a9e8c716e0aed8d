"""What a PNG says about itself, read without any library."""

import struct
from pathlib import Path


def chunks_of(path):
    """Return kind and content of each chunk of a PNG."""
    data = Path(path).read_bytes()
    assert data[:8] == b'\x89PNG\r\n\x1a\n'
    place, chunks = 8, []
    while place < len(data):
        length, kind = struct.unpack('>I4s', data[place : place + 8])
        chunks.append((kind.decode(), data[place + 8 : place + 8 + length]))
        place += length + 12
    return chunks


def size_of(path):
    """Return width and height, px."""
    return struct.unpack('>II', dict(chunks_of(path))['IHDR'][:8])


def numbers_text_of(path):
    """Return the text in which an image keeps the numbers that it was drawn from."""
    texts = [content.split(b'\0', 1) for kind, content in chunks_of(path) if kind == 'tEXt']
    return dict(texts)[b'Numbers'].decode()


def numbers_of(path):
    """Return these numbers by name."""
    parts = [part.rsplit(' = ', 1) for part in numbers_text_of(path).split('; ')]
    return {name: float(value) for name, value in parts}
