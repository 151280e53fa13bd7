#!/usr/bin/env python3
"""corpus_usb.py VECTORS OUT_DIR: first inputs of the fuzz targets of devices on USB.

Packets and reports of the test vectors, maps of them, and lives of a board: armed, pulling, disturbed, stopped.
"""
import json
import pathlib
import struct
import sys

DECODE, ENCODE = 0, 1
REPORT = 1  # any kind but a multiple of 4: a report of the length that is expected


def falcon(vectors):
    """(target, input): packets alone and in transfers, what is said while booting, numbers to encode."""
    for v in vectors["falcon_decode"] + vectors["falcon_decode_reject"]:
        data = bytes.fromhex(v["hex"])
        yield "fuzz_falcon", bytes([DECODE, 0, len(data) - 15]) + data
        yield "fuzz_falcon", bytes([DECODE, 2]) + 3 * (bytes([1, 1, 0x80 | 16]) + data + bytes([1]))
    greeting = bytes.fromhex("0a442c0d")
    for answer in (greeting, greeting[:2], bytes(2) + greeting, bytes(70)):
        yield "fuzz_falcon", bytes([DECODE, 1, 4, len(answer)]) + greeting + answer
    for first in range(8):
        yield "fuzz_falcon", bytes([ENCODE, first]) + bytes(range(40, 90))


def place(kind, offset, width):
    return struct.pack("<BHB", kind, offset, width - 1)


def maps():
    """(target, input): maps of three int16 and a number, of floats, big endian; as input and as output."""
    signed, big, single = 1, 2, 4
    layouts = [
        [(signed, 16 * i, 16) for i in range(3)],
        [(single, 0, 32), (single | big, 32, 32)],
        [(big | signed, 8, 24), (0, 32, 7), (0, 39, 1)],
    ]
    for layout in layouts:
        for mode in (DECODE, ENCODE):
            for more in (0, 2):
                fields = b"".join(place(*one) + bytes([1, 16, more]) + bytes(16) for one in layout)
                head = bytes([mode, 0, 8, len(layout)])
                yield "fuzz_report_map", head + fields + bytes([1, 0, 0]) + bytes(range(1, 60))


def descriptors():
    """(target, input): a board's descriptor with few bytes changed; raw HID."""
    raw = bytes.fromhex("06abff0a0002a1017508150026ff00954009018102954009029102c0")
    yield "fuzz_report_descriptor", bytes([DECODE, 0]) + raw
    for kind in (1, 2, 3, 5, 0x11, 0x15):
        yield "fuzz_report_descriptor", bytes([DECODE, kind, 40, 0, 7, 90, 0, 255])
        yield "fuzz_report_descriptor", bytes([ENCODE, kind])


def openffboard(vectors):
    """(target, input): reports, numbers to encode."""
    for group in ("openffboard_hidcmd", "openffboard_gamepad_in16", "pid_session"):
        for v in vectors[group]:
            data = bytes.fromhex(v["hex"])
            for which in (0, 1):
                kind = 4 * len(data) if 4 * len(data) < 256 else REPORT
                yield "fuzz_openffboard", bytes([DECODE, which, kind]) + data + bytes([1, 1, 0])
    for first in range(8):
        yield "fuzz_openffboard", bytes([ENCODE, 1, first]) + bytes(range(10, 60))


def lives():
    """(target, input): off for a while, armed and pulling, something happens, off. All kinds of boards."""
    off, armed, longer, event = 0, 1, 0x3C, 0xC0
    for kind in range(32):
        pull = b"".join(bytes([armed | longer, 8 + 4 * (i % 5), 20]) for i in range(9))
        happens = b"".join(bytes([armed | event, 10, 12, what]) + bytes(2) for what in (0, 1, 3, 8))
        life = bytes([off | longer]) + pull + happens + pull + bytes([off | longer] * 2)
        yield "fuzz_openffboard", bytes([DECODE, kind]) + life


def main():
    vectors = json.loads(pathlib.Path(sys.argv[1]).read_text())
    out = pathlib.Path(sys.argv[2])
    count = {}
    for source in (falcon(vectors), maps(), descriptors(), openffboard(vectors), lives()):
        for target, content in source:
            folder = out / target
            folder.mkdir(parents=True, exist_ok=True)
            count[target] = count.get(target, 0) + 1
            (folder / f"{count[target]:03}").write_bytes(content)


if __name__ == "__main__":
    main()
