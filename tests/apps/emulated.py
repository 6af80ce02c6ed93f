"""An emulated Gen3 in lock-step, beside which a test runs an arm."""

import re
import subprocess


class Emulated:
    """`pliant emulate gen3 --lock-step` at ports of its own; its address is HOST:TCP,UDP."""

    def __init__(self, pliant, *options):
        self.process = subprocess.Popen(
            [pliant, "emulate", "gen3", "--lock-step", "--port", "0", "--udp-port", "0", *options],
            stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        host, tcp, udp = re.fullmatch(r"listening on ([\d.]+):(\d+), UDP (\d+)\n", line).groups()
        self.address = f"{host}:{tcp},{udp}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.communicate(timeout=30)
