"""An emulated Gen3 as a client on the network meets it."""

import re
import signal
import socket
import struct

from command import InFolder, main

CREATE_SESSION, KEEP_ALIVE, GET_ARM_STATE, REFRESH_FEEDBACK = 0x10001, 0x10003, 0x200af, 0x30003
INVALID_PASSWORD, UNSUPPORTED_SERVICE = 15, 4


def text(number, words):
    return bytes([number << 3 | 2, len(words)]) + words.encode()


def frame(function, session=0, payload=b""):
    words = struct.pack("<BIBIBIBI", 0x0d, 1 << 28 | 1 << 24, 0x15, session << 16 | 1,
                        0x1d, 1 << 28 | function, 0x25, len(payload))
    body = bytes([0x0a, len(words)]) + words
    return body + (bytes([0x12, len(payload)]) + payload if payload else b"")


def opened(answer):
    """Session and error code of an answer."""
    frame_info, message_info = struct.unpack("<xIxI", answer[2:12])
    return message_info >> 16, frame_info & 0xfff


class EmulateGen3(InFolder):
    def listening(self, *options):
        """A process that listens on ports of its own."""
        process = self.start("emulate", "gen3", "--port", "0", "--udp-port", "0", *options)
        line = process.stdout.readline()
        found = re.fullmatch(r"listening on ([\d.]+):(\d+), UDP (\d+)\n", line)
        self.assertTrue(found, line)
        return process, int(found[2]), int(found[3])

    def ended(self, process):
        process.send_signal(signal.SIGINT)
        told, said = process.communicate(timeout=30)
        self.assertEqual(said, "")
        self.assertEqual(process.returncode, 0)
        return told

    def ask(self, port, function, session=0, payload=b""):
        """By TCP: a connection for each, so a session is of no use afterwards."""
        with socket.create_connection(("127.0.0.1", port), timeout=30) as tcp:
            sent = frame(function, session, payload)
            tcp.sendall(b"\x07xEtRoK\x07" + struct.pack(">I", len(sent)) + sent)
            with tcp.makefile("rb") as answer:
                prefix = answer.read(12)
                self.assertEqual(prefix[:8], b"\x07xEtRoK\x07")
                return answer.read(struct.unpack(">I", prefix[8:])[0])

    def test_answers_on_both_channels_and_ends_at_a_signal(self):
        process, port, udp_port = self.listening()
        admin = text(1, "admin") + text(3, "admin")
        session, error = opened(self.ask(port, CREATE_SESSION, 0, admin))
        self.assertEqual(error, 0)
        self.assertGreater(session, 0)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
            udp.settimeout(30)
            udp.connect(("127.0.0.1", udp_port))
            udp.send(b"nonsense")
            udp.send(frame(CREATE_SESSION, 0, admin))
            session, error = opened(udp.recv(4096))
            self.assertEqual(error, 0)
            udp.send(frame(REFRESH_FEEDBACK, session))
            self.assertGreater(len(udp.recv(4096)), 300)
            udp.send(frame(GET_ARM_STATE, session))
            self.assertEqual(opened(udp.recv(4096))[1], UNSUPPORTED_SERVICE)
        told = self.ended(process)
        self.assertRegex(told, r"^commands 0, sessions 2, connections 1, refused 1, unreadable 1, "
                               r"ticks \d+, lost ticks \d+, worst lateness \d+\.\d{3} ms\n$")

    def test_knows_one_user(self):
        process, port, _ = self.listening("--lock-step", "--user", "eve", "--password", "apple")
        for password, error in (("apple", 0), ("pear", INVALID_PASSWORD)):
            answer = self.ask(port, CREATE_SESSION, 0, text(1, "eve") + text(3, password))
            self.assertEqual(opened(answer)[1], error)
        self.assertIn("ticks 0,", self.ended(process))

    def test_warns_of_an_address_that_others_reach(self):
        process, _, _ = self.listening("--bind", "0.0.0.0", "--lock-step")
        self.assertEqual(process.stdout.readline(),
                         "warning: 0.0.0.0 is no address of this machine alone; who reaches it may "
                         "command\n")
        self.ended(process)

    def test_ends_by_itself(self):
        told = self.ends(0, "emulate", "gen3", "--port", "0", "--udp-port", "0", "--duration", "0.1",
                         "--ideal", "--payload", "1.5", "--position", "0", "15", "180", "-130", "0",
                         "55", "90", "--fault", "lost@1+0.5", "--fault", "overspeed@2+1:7")
        self.assertEqual(told.count("\n"), 2)

    def test_refuses_what_it_cannot_do(self):
        self.refuses("the fault 'torque_sensor_dead@1+2' does not say of which joint; expected its number "
                     "behind ':', such as 'torque_sensor_dead@1+2:4'",
                     "emulate", "gen3", "--fault", "torque_sensor_dead@1+2")
        self.refuses("the joint of the fault overspeed must be one of 1 … 7, got 8",
                     "emulate", "gen3", "--fault", "overspeed@1+2:8")
        self.refuses("position has an element for each of the 7 joints, got 2",
                     "emulate", "gen3", "--position", "0", "1")
        _, port, _ = self.listening("--lock-step")
        self.refuses(f"cannot listen on 127.0.0.1, port {port}: Address already in use; is another "
                     "emulator running? 0 is any port that is free",
                     "emulate", "gen3", "--port", str(port), "--udp-port", "0")

    def test_lists_the_faults(self):
        told = self.ends(0, "emulate", "gen3", "--help")
        for kind in ("lost", "servoing_refused", "torque_sensor_dead:J", "emergency_stop"):
            self.assertRegex(told, rf"\b{kind}\b")


if __name__ == "__main__":
    main()
