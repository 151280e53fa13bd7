#!/usr/bin/env python3
"""extract_vmlinux.py VMLINUZ VMLINUX: what the kernel would unpack at its start. Inside the emulator that takes longer
than all the rest of the boot, and only vmlinux can be entered directly."""
import lzma
import sys

XZ, ELF = b"\xfd7zXZ\x00", b"\x7fELF"


def unpack(image):
    at = image.find(XZ)
    while at >= 0:
        try:
            unpacked = lzma.LZMADecompressor(lzma.FORMAT_XZ).decompress(image[at:])
            if unpacked.startswith(ELF):
                return unpacked
        except lzma.LZMAError:
            pass  # these bytes were there by chance
        at = image.find(XZ, at + 1)
    return None


def main():
    with open(sys.argv[1], "rb") as file:
        vmlinux = unpack(file.read())
    if vmlinux is None:
        sys.exit(f"{sys.argv[1]}: no xz stream with an ELF file in it")
    with open(sys.argv[2], "wb") as file:
        file.write(vmlinux)


if __name__ == "__main__":
    main()
