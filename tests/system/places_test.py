#!/usr/bin/env python3
# Adds a toy effect, column, verb and law to a copy of the sources by touching exactly the files that docs/architecture.md names, and shows that they work.
import csv, gzip, os, pathlib, shutil, subprocess, sys, tempfile

sys.dont_write_bytecode = True
from link_again import compile_flags, libraries
from places import ADDITIONS, SOURCE
from program import CONFIG, expect

BUILD = pathlib.Path(sys.argv[1]).resolve()
expect((BUILD / "pneuservo").exists(), f"{BUILD}/pneuservo is not built")
work = pathlib.Path(tempfile.mkdtemp())

# The table names the files that an addition touches, and no other.
for one in ADDITIONS:
    named, touched = one.named() - set(one.beside), set(one.files())
    expect(named == touched, f"docs/architecture.md, row {one.kind}: not named {sorted(touched - named)}, not touched {sorted(named - touched)}")

copy = work / "copy"
for name in ("include", "src", "hal", "cmake", "docs", "tools", "tests/system"):
    shutil.copytree(SOURCE / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
shutil.copy(SOURCE / "CMakeLists.txt", copy)
for one in ADDITIONS:
    for edit in one.edits:
        edit.make(copy)


def must(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=1100, **options)
    expect(done.returncode == 0, f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


# The library that runs an axis, not optimised, and the smallest program on it and the simulated plant.
(work / "toy.cmake").write_text(f"""cmake_language(DEFER DIRECTORY {copy} CALL include {work}/target.cmake)\n""")
(work / "target.cmake").write_text("""file(GLOB sim ${CMAKE_SOURCE_DIR}/hal/sim/*.cpp)
add_executable(places ${CMAKE_SOURCE_DIR}/tests/system/places_program.cpp ${sim})
target_include_directories(places PRIVATE ${CMAKE_SOURCE_DIR}/hal)
target_link_libraries(places PRIVATE pneuservo_core)
""")
must("cmake", "-S", copy, "-B", work / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O0", "-DPNEUSERVO_BUILD_TESTS=OFF", "-DPNEUSERVO_UNITE_FOLDERS=ON",
     f"-DCMAKE_PROJECT_pneuservo_INCLUDE={work}/toy.cmake")
must("cmake", "--build", work / "build", "-j", os.cpu_count(), "--target", "places")
places = work / "build/places"


def rows(*sets):
    file = work / f"{len(list(work.glob('*.csv.gz')))}.csv.gz"
    must(places, "run", CONFIG, file, "duration_s=0.6", "controller.flow_feedforward=off", *sets)  # a pass carries what is known
    with gzip.open(file, "rt") as text:
        return list(csv.DictReader(line for line in text if not line.startswith("#")))


# The effect is a key, and slows the axis: 200 N s/m beside 60 N s/m leave it some 5 % short in this move.
keys = must(places, "keys")
expect("toy_gain_V_per_m" in keys, "keys: no toy_gain_V_per_m")
expect("toy_drag" in keys and "drag of a toy" in keys and "c of c v" in keys, "keys: no toy_drag")
expect(must(places, "words", "toy_drag") == "a toy's drag that is proportional to the speed\n", "the vocabulary has no toy_drag")
plain, dragged = rows(), rows("effects.toy_drag.coefficient_Ns_per_m=200")
viscous = rows("effects.viscous_friction.coefficient_Ns_per_m=200")
furthest = lambda run: max(abs(float(row["x_true_m"])) for row in run)
expect(furthest(dragged) < 0.99 * furthest(plain), f"toy_drag: {furthest(dragged)} m, without it {furthest(plain)} m")
expect([row["x_true_m"] for row in dragged] == [row["x_true_m"] for row in viscous], "toy_drag: not the motion of the same viscous friction")

# The column stands behind its neighbour and holds its value.
names = list(plain[0])
expect(names.index("toy_mps") == names.index("v_mps") + 1, f"columns: {names}")
expect(all(float(row["toy_mps"]) == 2 * float(row["v_mps"]) for row in plain), "toy_mps is not twice v_mps")

# The verb: its file and the table of verbs, linked with the libraries of the build that is there.
compiler, flags = compile_flags(BUILD, "src/program/verbs.cpp")
must(compiler, "-O0", *(word.replace(str(SOURCE), str(copy)) for word in flags), *(copy / f"src/program/{name}.cpp" for name in ("main", "verbs", "toy")),
     *libraries(BUILD), "-o", work / "pneuservo")
shown = must(work / "pneuservo", "--help")
expect("toy" in shown and "a toy of the test of places" in shown, f"--help: {shown}")
expect(must(work / "pneuservo", "toy") == "a toy\n", "the verb does not run")
shutil.rmtree(work)
