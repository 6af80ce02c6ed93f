"""Names what the shared libraries show besides pliant's own.

    symbols_test.py LIBRARY…

A template of std or Eigen that one of them shows would be taken by every other library of the program
that has it, be it compiled in another way.
"""

import re
import subprocess
import sys

OURS = re.compile(r"(?:(?:typeinfo|typeinfo name|vtable|VTT|construction vtable|guard variable) for "
                  r"|(?:non-virtual|virtual|covariant return) thunk to )?pliant::(?!\(anonymous namespace\))")


def problems(library):
    shown = subprocess.run(["nm", "-D", "--defined-only", "-C", library], check=True, stdout=subprocess.PIPE,
                           text=True).stdout.splitlines()
    names = [line.split(maxsplit=2)[2] for line in shown]
    if not any(name.startswith("pliant::") for name in names):
        return [f"{library} shows nothing"]
    return [f"{library}: {name}" for name in names if not OURS.match(name)]


def main():
    found = [problem for library in sys.argv[1:] for problem in problems(library)]
    print("\n".join(found[:50]))
    sys.exit(f"{len(found)} symbols that are not pliant's" if found else 0)


main()
