"""Talks to the appliance's Modbus server with pymodbus, a client that is not ours: every function code the design
promises, any unit id, the four-phase handshake, float word order, exceptions."""
import struct
import subprocess
import sys

from pymodbus.client import ModbusTcpClient


def expect(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: expected {expected!r}, found {found!r}")


def float_at(registers, address):
    return struct.unpack(">f", struct.pack(">HH", registers[address], registers[address + 1]))[0]


def main():
    server = subprocess.Popen([sys.argv[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        port = int(server.stdout.readline())
        client = ModbusTcpClient("127.0.0.1", port=port, timeout=2)
        assert client.connect(), "no connection"

        inputs = client.read_input_registers(0, 64, slave=1).registers
        expect("state", inputs[1], 5)
        expect("sequence", (inputs[20], inputs[57]), (41, 41))
        expect("x", float_at(inputs, 24), 123.5)
        expect("qw", float_at(inputs, 30), 1.0)

        for unit in (0, 1, 17, 247, 255):
            answer = client.read_holding_registers(0, 4, slave=unit)
            expect(f"unit {unit}", answer.isError(), False)

        expect("write one", client.write_register(3, 77, slave=9).isError(), False)
        expect("read back", client.read_holding_registers(3, 1, slave=9).registers, [77])

        # The four phases; the test server refuses every command with 116.
        expect("write many", client.write_registers(0, [1, 5], slave=1).isError(), False)
        for _ in range(200):
            echo = client.read_input_registers(3, 2, slave=1).registers
            if echo[0] == 1:
                break
        expect("echo and result", echo, [1, 116])
        expect("write 0", client.write_register(0, 0, slave=1).isError(), False)
        expect("echo cleared", client.read_input_registers(3, 2, slave=1).registers, [0, 0])

        both = client.readwrite_registers(read_address=2, read_count=2, write_address=2, values=[3, 78], slave=1)
        expect("read and write", both.registers, [3, 78])

        expect("past the end", client.read_holding_registers(10, 20, slave=1).exception_code, 2)
        expect("coils", client.read_coils(0, 1, slave=1).exception_code, 1)
        expect("still there", client.read_holding_registers(3, 1, slave=1).registers, [78])
        client.close()
    finally:
        server.stdin.close()
        server.wait(5)
    print("pymodbus: all as expected")


main()
