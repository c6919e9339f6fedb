#!/usr/bin/env python3
# tools/include-check passes this tree and a small sound one, and catches each planted violation at its line.
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SOUND = {
    "include/pneuservo/core/a.hpp": "// Core.\n#pragma once\n#include <cmath>\n#include <immintrin.h>\n",
    "include/pneuservo/elements/b.hpp": "// Element.\n#pragma once\n#include <Eigen/Core>\n#include <pneuservo/core/a.hpp>\n",
    "include/pneuservo/estimator/c.hpp": "// Estimator.\n#pragma once\n#include <pneuservo/elements/b.hpp>\n",
    "include/pneuservo/control/d.hpp": "// Control.\n#pragma once\n#include <pneuservo/elements/b.hpp>\n",
    "include/pneuservo/hal/e.hpp": "// Channel.\n#pragma once\n#include <pneuservo/core/a.hpp>\n",
    "include/pneuservo/rig/f.hpp": "// Rig.\n#pragma once\n#include <pneuservo/hal/e.hpp>\n",
    "src/config/g.hpp": "// Config.\n#pragma once\n#include <yaml-cpp/yaml.h>\nnamespace a {\nstruct Table {\n};\n}  // namespace a\n",
    "src/program/h.hpp": "// Verb.\n#pragma once\n#include \"config/g.hpp\"\n",
    "hal/sim/i.cpp": "// Backend.\n#include \"sim/j.hpp\"\n#include \"config/g.hpp\"\n",
    "hal/sim/j.hpp": "// Backend.\n#pragma once\nnamespace b {\nstruct Table {\n};\nnamespace {\nstruct Own {};\n}  // namespace\n}  // namespace b\n",
    "hal/sim/k.cpp": "// Backend.\nnamespace b {\nnamespace {\nstruct Own {};\nstruct Table {};\n}  // namespace\n}  // namespace b\n",
    "tools/script": "#!/bin/sh\n# A script.\n",
}
# name: (file, text, what the message must begin with)
PLANTED = {
    "core includes elements": ("include/pneuservo/core/x.hpp", "// X.\n#include <pneuservo/elements/b.hpp>\n",
                               "include/pneuservo/core/x.hpp:2: include/pneuservo/elements/b.hpp must not"),
    "elements include the estimator": ("include/pneuservo/elements/x.hpp", "// X.\n\n#include <pneuservo/estimator/c.hpp>\n",
                                       "include/pneuservo/elements/x.hpp:3: "),
    "control includes a device": ("include/pneuservo/control/x.hpp", "// X.\n#include <pneuservo/hal/e.hpp>\n",
                                  "include/pneuservo/control/x.hpp:2: "),
    "the estimator includes yaml-cpp": ("include/pneuservo/estimator/x.hpp", "// X.\n#  include <yaml-cpp/yaml.h>\n",
                                        "include/pneuservo/estimator/x.hpp:2: <yaml-cpp/yaml.h> does not belong"),
    "an element includes a system header": ("include/pneuservo/elements/x.hpp", "// X.\n#include <sys/mman.h>\n",
                                            "include/pneuservo/elements/x.hpp:2: <sys/mman.h>"),
    "record includes a rig": ("include/pneuservo/record/x.hpp", "// X.\n#include <pneuservo/rig/f.hpp>\n",
                              "include/pneuservo/record/x.hpp:2: include/pneuservo/rig/f.hpp must not"),
    "a public header includes a private one": ("include/pneuservo/rig/x.hpp", '// X.\n#include "config/g.hpp"\n',
                                               "include/pneuservo/rig/x.hpp:2: src/config/g.hpp must not"),
    "config includes a verb": ("src/config/x.cpp", '// X.\n#include "program/h.hpp"\n', "src/config/x.cpp:2: src/program/h.hpp"),
    "a backend includes a verb": ("hal/can/x.cpp", '// X.\n#include "program/h.hpp"\n', "hal/can/x.cpp:2: src/program/h.hpp"),
    "the loop includes a backend": ("src/loop/x.cpp", '// X.\n#include "sim/j.hpp"\n', "src/loop/x.cpp:2: hal/sim/j.hpp"),
    "a file that is not there": ("src/config/x.cpp", '// X.\n#include "config/none.hpp"\n', "src/config/x.cpp:2: config/none.hpp: no such"),
    "a folder without a rule": ("src/novel/x.cpp", "// X.\n", "src/novel/x.cpp:1: the folder stands in no rule"),
    "the independent machine includes the library": ("tests/proof/machine/x.cpp", "// X.\n#include <pneuservo/core/a.hpp>\n",
                                                     "tests/proof/machine/x.cpp:2: include/pneuservo/core/a.hpp must not"),
    "the independent machine includes Eigen": ("tests/proof/machine/x.cpp", "// X.\n#include <Eigen/Core>\n",
                                                "tests/proof/machine/x.cpp:2: <Eigen/Core> does not belong"),
    "two types of one name": ("src/record/x.hpp", "// X.\n#pragma once\nnamespace a {\nstruct Table : Other {\n};\n}  // namespace a\n",
                              "src/record/x.hpp:4: a::Table is defined in src/config/g.hpp too"),
    "a key beside another member": ("include/pneuservo/rig/x.hpp", '// X.\n\n  v(Field{"length_m", "m", 0, 1,\n          "of the line"},\n    p.lenght_m...);\n',
                                    "include/pneuservo/rig/x.hpp:3: the key length_m has the member lenght_m"),
    "a circle": ("include/pneuservo/core/a.hpp", "// Core.\n#include <pneuservo/core/x.hpp>\n", None),
    "no first comment": ("src/config/x.cpp", "#include <cmath>\n", "src/config/x.cpp:1: the file does not begin"),
    "no comment under the shebang": ("tools/script", "#!/bin/sh\nexit 0\n", "tools/script:2: the file does not begin"),
}


def check(root):
    done = subprocess.run([SOURCE / "tools/include-check", "--root", root], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout.splitlines(), done.stderr


def plant(root, files):
    for name, text in files.items():
        path = pathlib.Path(root, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def main():
    failures = []
    status, lines, errors = check(SOURCE)
    if status != 0:
        failures.append("this tree: " + "\n  ".join(lines + [errors]))
    with tempfile.TemporaryDirectory() as root:
        plant(root, SOUND)
        status, lines, errors = check(root)
        if status != 0:
            failures.append(f"the sound tree is refused ({status}): {lines} {errors}")
    for name, (path, text, message) in PLANTED.items():
        with tempfile.TemporaryDirectory() as root:
            files = {**SOUND, path: text}
            if name == "a circle":
                files["include/pneuservo/core/x.hpp"] = "// X.\n#include <pneuservo/core/a.hpp>\n"
                message = "include/pneuservo/core/x.hpp:2: includes in a circle"
            plant(root, files)
            status, lines, _ = check(root)
            if status != 1 or len(lines) != 1 or not lines[0].startswith(message):
                failures.append(f"{name}: status {status}, expected one line '{message}...', found {lines}")
    with tempfile.TemporaryDirectory() as root:
        if check(root)[0] != 2:
            failures.append("an empty tree is not refused")
    for failure in failures:
        print("FAILED", failure)
    print(f"{len(PLANTED)} planted violations, {len(failures)} failures")
    return 1 if failures else 0


sys.exit(main())
