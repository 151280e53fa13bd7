#!/usr/bin/env python3
"""corpus.py VECTORS OUT_DIR: first inputs of the fuzz targets.

Each frame of the test vectors becomes a file for its protocol's target (input.h: which bytes mean
what), and each target gets a life of a drive: connected, armed, pulling, stopped.
"""
import json
import pathlib
import struct
import sys

DECODE, ENCODE, SESSION = 0, 1, 2
EXTENDED, REMOTE, ERROR, FD, FAST = 1, 2, 4, 8, 16


def flags_of(vector):
    """Of a frame whose id is as it is."""
    names = {"extended": EXTENDED, "rtr": REMOTE, "error": ERROR, "fd": FD, "brs": FAST}
    return sum(bit for name, bit in names.items() if vector.get(name))


def frame_of(can_id, flags, data):
    return struct.pack("<BIB", flags, can_id, len(data)) + data


def frames(vectors):
    """(target, input) of all vectors that are frames."""
    for group in ("decode", "classify", "encode"):
        for v in vectors["odrive_cansimple"][group]:
            node = v.get("configured_node", v["can_id"] >> 5)
            data = bytes.fromhex(v["data"])
            yield "fuzz_odrive", bytes([DECODE, node]) + frame_of(v["can_id"], flags_of(v), data)
    for v in vectors["moteus"]["decode"]:
        data = bytes.fromhex(v["data"])
        yield "fuzz_moteus", bytes([DECODE, 0, 0]) + frame_of(0x100, FD | FAST, data)
    for group in ("nmt", "sync", "rpdo1", "tpdo1", "tpdo2", "heartbeat", "emcy", "sdo_abort"):
        for v in vectors["cia402"][group]:
            node = v.get("node") or 1
            data = bytes.fromhex(v["data"])
            yield "fuzz_cia402", bytes([DECODE, node - 1]) + frame_of(v["can_id"], 0, data)
    for v in vectors["cia402"]["sdo_configure_cst"]:
        data = bytes.fromhex(v["reply_ok"])
        yield "fuzz_cia402", bytes([DECODE, v["node"] - 1]) + frame_of(v["reply_can_id"], 0, data)
    for v in vectors["cia402"]["sdo_upload"]:
        data = bytes.fromhex(v["reply"])
        yield "fuzz_cia402", bytes([DECODE, v["node"] - 1]) + frame_of(v["reply_can_id"], 0, data)


def edges():
    """(target, input): numbers that are none, registers and counts beyond what there is."""
    singles = [struct.pack("<f", float(x)) for x in ("nan", "inf", "-inf", "1", "3.4e38")]
    for command in (0x09, 0x14, 0x15, 0x17, 0x1C):
        for first in singles:
            data = first + singles[3]
            yield "fuzz_odrive", bytes([DECODE, 3]) + frame_of(3 << 5 | command, 0, data)
            data = singles[3] + first
            yield "fuzz_odrive", bytes([DECODE, 3]) + frame_of(3 << 5 | command, 0, data)
    for hex_data in ("22ffffffff0f010a", "21808080801005", "20ffffffff0f0001", "2d017f800000",
                     "24038080048001ff7f", "210080", "2c020100c07f0000807f", "208000", "30018020"):
        data = bytes.fromhex(hex_data)
        yield "fuzz_moteus", bytes([DECODE, 0, 0]) + frame_of(0x100, FD | FAST, data)


def lives():
    """(target, input): set up undisturbed, armed for ticks of 8 and 1 ms, off; twice.

    In some of them a byte of what comes is spoilt now and then.
    """
    slow, tick, off, foreign = 0x02, 0x00, 0x30, 0x08
    for kind in range(8):
        life = bytes([0] + 2 * ([slow] * 18 + [tick] * 4 + [off] * 2))
        if kind >= 4:
            spoilt = b"".join(bytes([tick | foreign, at]) for at in range(1, 9))
            life = bytes([0] + [slow] * 18) + spoilt + bytes([off] * 2)
        yield "fuzz_odrive", bytes([SESSION, kind, 3]) + life
        yield "fuzz_moteus", bytes([SESSION, kind, 0, 0]) + life
        yield "fuzz_cia402", bytes([SESSION, kind, 0]) + life


def numbers():
    """(target, input): what the encoders get."""
    for first in range(8):
        rest = bytes(range(40, 100))
        for target in ("fuzz_odrive", "fuzz_cia402"):
            yield target, bytes([ENCODE, 3, first]) + rest
        yield "fuzz_moteus", bytes([ENCODE, 0, 3, first]) + rest


def batches(vectors):
    """(target, input): frames that come to a socket, and frames that leave it."""
    data = bytes.fromhex(vectors["moteus"]["decode"][0]["data"])
    kernel = struct.pack("<IBBBB64s", 0x100, len(data), 5, 0, 0, data)
    yield "fuzz_socket", bytes([0, 2, 1]) + kernel + bytes([0]) + kernel[:16]
    yield "fuzz_socket", bytes([1, 2]) + 2 * frame_of(0x100, FD | FAST, data)


def usb_hosts():
    """(target, input): requests, whole and as bytes; sessions that submit, wait, take back, unplug."""
    setup = bytes([0x80, 6, 0, 1, 0, 0, 18, 0])
    submit = struct.pack(">IIIIIIIIII", 1, 1, 0x10002, 1, 0, 0, 18, 0, 0xFFFFFFFF, 0) + setup
    unlink = struct.pack(">IIIIII24x", 2, 9, 0x10002, 0, 0, 1)
    reply = struct.pack(">IIIIIIIIII8x", 3, 1, 0, 0, 0, 0, 18, 0, 0xFFFFFFFF, 0)
    imported = struct.pack(">HHI40s", 0x0111, 0x8003, 0, b"1-1")
    for message in (submit, unlink, reply, imported):
        yield "fuzz_usbip", bytes([0]) + message
    answered = bytes([0x40, 1, 1, 0, 18]) + setup + bytes([0x40, 2, 0, 2, 8]) + bytes(8)
    waiting = bytes([0x40, 3, 1, 1, 64]) + bytes(8) + bytes([0x03, 3])
    for end in (bytes([0x06]), bytes([0x07, 60]) + submit, bytes([0x45, 5, 0x44, 1])):
        yield "fuzz_usbip", bytes([1, 0, 0, 0, 0]) + answered + waiting + end
        yield "fuzz_usbip", bytes([1, 1, 1, 1, 1]) + 2 * answered + waiting + end


def main():
    vectors = json.loads(pathlib.Path(sys.argv[1]).read_text())
    out = pathlib.Path(sys.argv[2])
    count = {}
    for source in (frames(vectors), edges(), lives(), numbers(), batches(vectors), usb_hosts()):
        for target, content in source:
            folder = out / target
            folder.mkdir(parents=True, exist_ok=True)
            count[target] = count.get(target, 0) + 1
            (folder / f"{count[target]:03}").write_bytes(content)


if __name__ == "__main__":
    main()
