"""PointCloud2 messages by the letter of their specification, right and wrong ones."""

import struct


def cloud_of(fields, data, *, height=1, width=1, step=4, row=None, big=False, length=None):
    """Return a PointCloud2 as its specification says, whatever it claims."""
    out = bytearray(b'\x00\x01\x00\x00')

    def put(form, *values):
        size = struct.calcsize(form[-1])
        out.extend(bytes(-(len(out) - 4) % size) + struct.pack(f'<{form}', *values))

    def text(words):
        put('I', len(words.encode()) + 1)
        out.extend(words.encode() + b'\0')

    put('iI', 1, 0)
    text('world')
    put('III', height, width, len(fields))
    for name, offset, datatype, count in fields:
        text(name)
        put('I', offset)
        put('B', datatype)
        put('I', count)
    put('B', big)
    put(
        'III',
        step,
        width * step % 2**32 if row is None else row,
        len(data) if length is None else length,
    )
    return bytes(out) + data + b'\x01'


X = ('x', 0, 7, 1)

MOST = 2**32 - 1
