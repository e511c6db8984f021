"""The PLC that a test plays: a Modbus TCP client that holds the belt and beats its heart."""

import socket
import struct
import sys
import time


def expect(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: expected {expected!r}, found {found!r}")


class Plc:
    """A Modbus TCP client that holds the belt and beats its heart with every look."""

    def __init__(self, port, patience_s=20):
        give_up = time.monotonic() + patience_s
        while True:
            try:
                self.socket = socket.create_connection(("127.0.0.1", port), timeout=5)
                break
            except OSError:
                if time.monotonic() > give_up:
                    sys.exit("beltpickd does not listen")
                time.sleep(0.05)
        self.beat = 0
        self.write(0, [0, 0, 3, 0])

    def ask(self, pdu):
        self.socket.sendall(struct.pack(">HHHB", 1, 0, len(pdu) + 1, 1) + pdu)
        head = self.socket.recv(7, socket.MSG_WAITALL)
        body = self.socket.recv(struct.unpack(">H", head[4:6])[0] - 1, socket.MSG_WAITALL)
        expect("Modbus answer", body[0], pdu[0])
        return body

    def write(self, address, values):
        count = len(values)
        self.ask(struct.pack(f">BHHB{count}H", 16, address, count, 2 * count, *values))

    def inputs(self):
        self.beat = (self.beat + 1) % 65536
        self.write(3, [self.beat])
        return struct.unpack(">64H", self.ask(struct.pack(">BHH", 4, 0, 64))[2:])

    def wait(self, what, condition, patience_s=20):
        give_up = time.monotonic() + patience_s
        while time.monotonic() < give_up:
            inputs = self.inputs()
            if condition(inputs):
                return inputs
            time.sleep(0.005)
        sys.exit(f"{what}: not within {patience_s} s; state {inputs[1]}, fault {inputs[5]}, last code {inputs[6]}")

    def command(self, number):
        self.write(0, [number])
        result = self.wait(f"echo of command {number}", lambda inputs: inputs[3] == number)[4]
        self.write(0, [0])
        self.wait("echo cleared", lambda inputs: inputs[3] == 0)
        return result
