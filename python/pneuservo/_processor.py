# Which of the modules of an installation this processor runs.
"""Debian's package holds the compiled module twice, as it does the library: for any x86-64, and for those with AVX2."""
import os
from typing import List

# What x86-64-v3 adds, by the kernel's names (System V ABI for x86-64, micro-architecture levels).
_V3 = frozenset("avx avx2 bmi1 bmi2 f16c fma abm movbe xsave".split())


def _flags() -> "frozenset[str]":
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            return frozenset(next((line.split(":")[1] for line in file if line.startswith("flags")), "").split())
    except OSError:
        return frozenset()


def folders(package: str) -> List[str]:
    """Where parts of the package are looked for, the module's own folder first where there is one."""
    newer = os.path.join(package, "x86-64-v3")
    return [newer, package] if os.path.isdir(newer) and _V3 <= _flags() else [package]
