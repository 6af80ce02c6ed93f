"""`pliant emulate`: sensors that are not there, read by sockets and a terminal of Python's own."""

import os
import re
import select
import signal
import socket
import struct
import time

from command import InFolder, main

STOP = struct.pack(">HHI", 0x1234, 0, 0)


def start(count=0):
    """A request for so many records, which a socket can hold; 0: for all."""
    return struct.pack(">HHI", 0x1234, 2, count)


def crc16_x25(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return crc ^ 0xFFFF


class Emulate(InFolder):
    def rdt(self, *options):
        """An emulator at any free port, and a socket connected to it."""
        process = self.start("emulate", "rdt", "--port", "0", *options)
        first = process.stdout.readline()
        self.assertRegex(first, r"^listening at 127\.0\.0\.1:\d+\n$")
        s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(s.close)
        s.settimeout(10)
        s.connect(("127.0.0.1", int(first.rsplit(":", 1)[1])))
        return process, s

    def bota(self, *options):
        """An emulator and the terminal it writes to."""
        process = self.start("emulate", "bota", *options)
        terminal = os.open(process.stdout.readline().strip(), os.O_RDONLY | os.O_NOCTTY)
        self.addCleanup(os.close, terminal)
        return process, terminal

    def read(self, terminal, size):
        data = b""
        while len(data) < size:
            self.assertTrue(select.select([terminal], [], [], 10)[0], "it sends nothing")
            data += os.read(terminal, 4096)
        return data

    def ends_by(self, by, process, said):
        process.send_signal(by)
        told, fault = process.communicate(timeout=10)
        self.assertEqual(fault, "")
        self.assertRegex(told, said)
        self.assertEqual(process.returncode, 0)

    def test_sends_rdt_records_to_who_asks(self):
        process, s = self.rdt()
        s.send(start(200))
        records = [struct.unpack(">3I6i", s.recv(100)) for _ in range(200)]
        self.assertEqual([r[0] for r in records], list(range(1, 201)))
        self.assertEqual({b[1] - a[1] for a, b in zip(records, records[1:])}, {1})
        self.assertEqual({r[2] for r in records}, {0})
        for r in records:
            self.assertEqual(r[3:5] + r[6:], (0, 0, 0, 0, 0))
            self.assertTrue(-5000000 <= r[5] <= 0, "the push along z, in millionths of a newton")
        s.send(start())
        s.recv(100)
        s.send(STOP)
        s.settimeout(0.5)
        with self.assertRaises(TimeoutError):
            for _ in range(100000):
                s.recv(100)
        self.ends_by(signal.SIGINT, process, r"^sent \d+ records\n$")

    def test_sends_bota_frames(self):
        process, terminal = self.bota()
        data = self.read(terminal, 200 * 37)
        begin = next(i for i in range(37) if data[i] == 0xAA and
                     crc16_x25(data[i + 1:i + 35]) == struct.unpack_from("<H", data, i + 35)[0])
        frames = [data[i:i + 37] for i in range(begin, len(data) - 36, 37)]
        times = []
        for frame in frames:
            header, status, *rest, crc = struct.unpack("<BH6fIfH", frame)
            self.assertEqual((header, status, crc), (0xAA, 0, crc16_x25(frame[1:35])))
            times.append(rest[6])
        self.assertEqual({b - a for a, b in zip(times, times[1:])}, {1250})
        self.ends_by(signal.SIGTERM, process, r"^sent \d+ frames\n$")

    def test_shows_faults_when_they_are_ordered(self):
        # All along: neither depends on when the first request comes.
        process, s = self.rdt("--fault", "duplicated@0+1000", "--fault", "frozen@0+1000")
        s.send(start(50))
        records = [struct.unpack(">3I6i", s.recv(100)) for _ in range(100)]
        self.assertEqual([r[0] for r in records], [1 + k // 2 for k in range(100)])
        self.assertEqual({r[1] for r in records}, {0})
        process.kill()

        process, s = self.rdt("--fault", "corrupted@0+1000")
        s.send(start(40))
        self.assertTrue(all(len(s.recv(100)) < 36 for _ in range(40)))
        process.kill()

        process, terminal = self.bota("--fault", "silent@0+0.3")
        _, status, *_, stamp, _, _ = struct.unpack("<BH6fIfH", self.read(terminal, 37)[:37])
        self.assertEqual((status, stamp), (0, 0), "it begins anew")
        process.kill()

    def test_ends_by_itself(self):
        begin = time.monotonic()
        self.assertRegex(self.ends(0, "emulate", "rdt", "--port", "0", "--duration", "0.3"),
                         r"^listening at 127\.0\.0\.1:\d+\nsent 0 records\n$")
        told = self.ends(0, "emulate", "bota", "--duration", "0.3")
        self.assertGreaterEqual(time.monotonic() - begin, 0.6)
        # The terminal keeps what nobody reads until it is full.
        self.assertRegex(told, r"^/dev/pts/\d+\nsent \d+ frames\n$")
        self.assertGreater(int(re.search(r"sent (\d+)", told)[1]), 50)

    def test_binds_to_this_machine_unless_told(self):
        process, s = self.rdt()
        port = s.getpeername()[1]
        # Of all addresses of a machine that begin with 127 it listens at one.
        other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(other.close)
        other.bind(("127.0.0.2", port))
        process.kill()
        process = self.start("emulate", "rdt", "--port", "0", "--bind", "127.0.0.2")
        self.assertRegex(process.stdout.readline(), r"^listening at 127\.0\.0\.2:\d+\n$")
        process.kill()

    def test_refuses_what_it_cannot_do(self):
        self.refuses("the fault 'lots@1+1' is of no kind that is known; did you mean 'lost'?; expected one of "
                     "lost, late, duplicated, reordered, corrupted, frozen, silent",
                     "emulate", "rdt", "--port", "0", "--fault", "lots@1+1")
        self.refuses("the fault 'lost' does not say when; expected KIND@START+DURATION in seconds, such as "
                     "'lost@1+0.5'", "emulate", "bota", "--fault", "lost")
        self.refuses("cannot listen at 'here': expected an IPv4 address of this machine, such as 127.0.0.1, or "
                     "0.0.0.0 for all it has", "emulate", "rdt", "--bind", "here")
        self.refuses("--force must be finite N, got nan", "emulate", "bota", "--force", "0", "0", "nan")
        self.refuses("there is no command 'rtd'; did you mean 'rdt'?\n`pliant --help` names them", "emulate", "rtd")
        for words in (["rdt", "--port", "70000"], ["bota", "--duration", "-1"], ["rdt", "--bind", ""], []):
            self.ends(2, "emulate", *words)

    def test_says_that_a_port_is_taken(self):
        process, s = self.rdt()
        port = s.getpeername()[1]
        self.refuses(f"cannot listen at 127.0.0.1:{port}: Address already in use; port 0 is any that is free",
                     "emulate", "rdt", "--port", str(port))
        process.kill()


if __name__ == "__main__":
    main()
