# Links the program of a build anew, with some of its objects replaced: the libraries give the rest.
import json
import pathlib
import shlex


def compile_flags(build, source):
    """Compiler and flags by which the build compiles this source, without its output and optimisation."""
    entry = next(one for one in json.loads((build / "compile_commands.json").read_text()) if one["file"].endswith(source))
    words = shlex.split(entry["command"])
    compiler = next(word for word in words if pathlib.Path(word).name.rstrip("0123456789-.") in ("c++", "g++", "clang++"))
    flags = []
    for before, word in zip(words, words[1:]):
        if word.startswith(("-I", "-D", "-std", "-f", "-march")):
            flags.append(word)
        elif before == "-isystem":
            flags += ["-isystem", word]
    return compiler, flags


def libraries(build):
    """What the program is linked with, as whole paths; in a group, for a replaced object may need any of them."""
    rule = next(part for part in (build / "build.ninja").read_text().split("\nbuild ") if part.startswith("pneuservo: CXX_EXECUTABLE"))
    line = next(line for line in rule.splitlines() if line.strip().startswith("LINK_LIBRARIES"))
    words = [str(build / word) if word.endswith(".a") and not word.startswith("/") else word for word in line.split("=", 1)[1].split()]
    return ["-Wl,--start-group", *words, "-Wl,--end-group"]
