# SPDX-License-Identifier: Apache-2.0
"""Captures of USB traffic as Wireshark writes them: pcap and pcapng of usbmon packets. Sources:
"Link-Layer Header Types" (LINKTYPE_USB_LINUX and _MMAPPED), tcpdump.org; "PCAP Now Generic Dump
File Format", ietf-opsawg-pcap."""
import struct

USB_LINUX, USB_LINUX_MMAPPED = 189, 220
CONTROL, INTERRUPT = 2, 1
BUS, DEVICE = 2, 5
DEVICE_DESCRIPTOR = struct.pack("<BBHBBBBHHHBBBB", 18, 1, 0x0200, 0, 0, 0, 64, 0x1209, 0x0001,
                                0x0101, 1, 2, 3, 1)
GET_DEVICE_DESCRIPTOR = struct.pack("<BBHHH", 0x80, 6, 0x0100, 0, 18)


def packet(order, time_us, kind, transfer, endpoint, data, link, setup=None):
    seconds, us = divmod(time_us, 1_000_000)
    head = struct.pack(order + "QBBBBHBBqiiII", 900 if setup else 1, ord(kind), transfer, endpoint,
                       DEVICE, BUS, 0 if setup else ord("-"), 0 if data else ord("<"), seconds, us,
                       0, len(data), len(data))
    head += setup or bytes(8)
    if link == USB_LINUX_MMAPPED:
        head += struct.pack(order + "iiII", 0, 0, 0, 0)
    return head + data


def packets(order, reports, link):
    begin_us = 1_790_000_000_000_000
    yield begin_us, packet(order, begin_us, "S", CONTROL, 0x80, b"", link, GET_DEVICE_DESCRIPTOR)
    yield begin_us, packet(order, begin_us, "C", CONTROL, 0x80, DEVICE_DESCRIPTOR, link)
    for number, report in enumerate(reports):
        time_us = begin_us + 2000 * number
        yield time_us, packet(order, time_us, "C", INTERRUPT, 0x81, report, link)


def pcap(reports, order="<", link=USB_LINUX):
    out = struct.pack(order + "IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 1 << 18, link)
    for time_us, data in packets(order, reports, link):
        out += struct.pack(order + "IIII", *divmod(time_us, 1_000_000), len(data), len(data)) + data
    return out


def pcapng(reports, order="<", link=USB_LINUX):
    def block(kind, content):
        size = 12 + len(content)
        return struct.pack(order + "II", kind, size) + content + struct.pack(order + "I", size)

    out = block(0x0A0D0D0A, struct.pack(order + "IHHq", 0x1A2B3C4D, 1, 0, -1))
    out += block(1, struct.pack(order + "HHI", link, 0, 1 << 18))
    for time_us, data in packets(order, reports, link):
        out += block(6, struct.pack(order + "IIIII", 0, time_us >> 32, time_us & 0xFFFFFFFF,
                                    len(data), len(data)) + data + bytes(-len(data) % 4))
    return out
