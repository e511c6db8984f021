"""Ports and addresses of this machine that nobody uses, so that tests run side by side."""

import socket
import sys


def free_port():
    """A TCP port on loopback."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def free_camera_address(network):
    """A loopback address whose GigE Vision port is free, of 127.0.<network>."""
    for last in range(1, 250):
        address = f"127.0.{network}.{last}"
        with socket.socket(type=socket.SOCK_DGRAM) as probe:
            try:
                probe.bind((address, 3956))
                return address
            except OSError:
                continue
    sys.exit("no loopback address with a free UDP port 3956")
