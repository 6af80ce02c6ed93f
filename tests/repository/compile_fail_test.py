"""Compiles a file that must not compile, and reads the compiler's message.

    compile_fail_test.py FILE COMPILER [FLAG…]

The first line of FILE is `// ` and a text that the compiler has to print.
"""

import os
import subprocess
import sys

source, compiler, *flags = sys.argv[1:]
with open(source, encoding="utf-8") as file:
    first = file.readline().rstrip("\n")
if not first.startswith("// ") or len(first) < 8:
    sys.exit(f"{source}:1: must be `// ` and the text that the compiler has to print")
expected = first[3:]

# Without carets the compiler prints messages only, so the text cannot come from the source itself.
done = subprocess.run([compiler, *flags, "-std=c++20", "-fsyntax-only", "-fno-diagnostics-show-caret",
                       "-fmessage-length=0", source],
                      capture_output=True, text=True, env={**os.environ, "LC_ALL": "C.UTF-8"})
if done.returncode == 0:
    sys.exit(f"{source}: compiles, and must not; expected: {expected}")
if expected not in done.stderr:
    sys.exit(f"{source}: the compiler does not say\n  {expected}\nbut\n{done.stderr}")
print(f"says: {expected}")
