"""The wire format, against bytes written by hand from its rules."""

import pytest

from circle_bounce_ros.encoding import PoseStampedEncoder
from circle_bounce_ros.encoding.layout import FLOAT32, FLOAT64, INT32, UINT8, UINT32, Layout


def body(layout):
    content = layout.finish().to_bytes()
    assert content[:4] == bytes([0, 1, 0, 0])  # CDR, little-endian, no options
    return content[4:]


def test_a_number_lies_at_a_multiple_of_its_size():
    layout = Layout()
    layout.put(UINT8, 7)
    layout.put(INT32, -2)
    layout.put(UINT8, [1, 2])
    layout.put(FLOAT64, 1.0)
    layout.put(UINT8, 3)
    layout.put(FLOAT32, 1.0)
    assert body(layout) == (
        b'\x07' b'\0\0\0' b'\xfe\xff\xff\xff' b'\x01\x02' b'\0\0\0\0\0\0'
        b'\0\0\0\0\0\0\xf0\x3f' b'\x03' b'\0\0\0' b'\0\0\x80\x3f'
    )  # fmt: skip


def test_a_string_is_its_length_with_the_nul_its_utf8_bytes_and_the_nul():
    layout = Layout()
    layout.put_string('', 'a')
    layout.put_string('é', 'b')
    assert body(layout) == b'\x01\0\0\0' b'\0' b'\0\0\0' b'\x03\0\0\0' b'\xc3\xa9\0'  # fmt: skip


def test_a_sequence_is_its_length_and_its_elements():
    layout = Layout()
    layout.put_sequence(FLOAT64, [(1.0, 0.0)])
    assert body(layout) == b'\x01\0\0\0' b'\0\0\0\0' b'\0\0\0\0\0\0\xf0\x3f' + bytes(8)  # fmt: skip


def test_an_empty_sequence_aligns_nothing():
    layout = Layout()
    layout.put_sequence(FLOAT64, [])
    layout.put(UINT8, 9)
    assert body(layout) == b'\0\0\0\0' b'\x09'  # fmt: skip


def test_what_is_written_to_a_view_is_written_to_the_message_and_to_nothing_else():
    layout = Layout()
    layout.put(UINT8, 1)
    slot = layout.put(UINT32, [2, 3])
    layout.put(UINT8, 4)
    message = layout.finish()
    before = message.to_bytes()
    message.view(slot)[1] = 0x01020304
    assert before[4:] == b'\x01\0\0\0' b'\x02\0\0\0' b'\x03\0\0\0' b'\x04'  # fmt: skip
    assert message.to_bytes() == before[:12] + b'\x04\x03\x02\x01' + before[16:]


def test_a_nul_in_a_string_is_refused():
    with pytest.raises(ValueError, match=r"^frame_id: must not contain a NUL, got 'a\\x00b'$"):
        PoseStampedEncoder('a\0b')


def test_a_pose_byte_by_byte():
    encoded = PoseStampedEncoder('map').encode(3_000_000_004, (1.0, -2.0))
    assert encoded.hex(' ', 4) == (
        '00010000 '  # CDR, little-endian
        '03000000 04000000 '  # stamp: seconds, nanoseconds
        '04000000 6d617000 '  # frame_id: length, m a p NUL
        '00000000 0000f03f '  # position: x
        '00000000 000000c0 '  # y
        '00000000 00000000 '  # z
        '00000000 00000000 '  # orientation: x
        '00000000 00000000 '  # y
        '00000000 00000000 '  # z
        '00000000 0000f03f'  # w
    )
