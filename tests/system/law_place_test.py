#!/usr/bin/env python3
# A new control law is one file and one line: names, keys, dispatch, columns, checks and manual know it. What it lacks
# is a compile error that says so.
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import toy_law

BUILD = pathlib.Path(sys.argv[1])
SOURCE = pathlib.Path(__file__).resolve().parents[2]
# Sources that ask which law a config has: those that can stand in one file are compiled in one.
ASKING = [["src/config/rig_checks.cpp", "src/design/axis_design.cpp", "src/loop/axis_loop.cpp", "src/report/run_report.cpp",
           "src/program/run.cpp"],
          ["src/config/config_manual.cpp"]]
PROBE = """#include <cstdio>
#include <pneuservo/control/axis_controller.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>
using namespace pneuservo;
int main() {
  ControllerParameters parameters;
  std::vector<std::string_view> keys;
  parameters.kind = kind_of<ToyLaw>;
  ControllerParameters::visit([&](const Field& field, auto&) { keys.push_back(field.key); }, parameters);
  for (const std::string_view name : controller_kind_names) std::printf("law %s\\n", name.data());
  for (const std::string_view key : keys) std::printf("key %s\\n", key.data());
  for (const std::string_view column : law_columns(parameters.kind)) std::printf("column %s\\n", column.data());
  for (std::size_t i = 0; i < 3; ++i)
    if (runs(parameters.kind, static_cast<RigKind>(i))) std::printf("rig %s\\n", rig_kind_names[i].data());
  parameters.of<ToyLaw>().toy_gain_V_per_m = 40.0;
  AxisController controller;
  controller.configure(parameters, {}, 0.001, {}, 1.0);
  ControlInput in;
  in.x_m = -0.25;
  Row row;
  std::printf("command %g\\n", controller.step(in).command_V[0]);
  controller.write_terms(true, row.terms);
  std::printf("term %g\\n", row.terms[0]);
}
"""


def cached(name):
    return re.search(rf"^{name}:\w+=(.*)$", (BUILD / "CMakeCache.txt").read_text(), re.MULTILINE)[1]


def compile_in(tree, *arguments):
    command = [cached("CMAKE_CXX_COMPILER"), "-std=c++20", "-ffp-contract=off", "-DFMT_SHARED",
               '-DPNEUSERVO_VERSION="0"', "-I", tree / "include", "-I", tree / "src", "-I", tree / "hal",
               "-isystem", "/usr/include/eigen3", *arguments]
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600)


def expect(condition, what):
    if not condition:
        sys.exit(f"law_place_test.py: {what}")


def scratch(folder, without=None):
    tree = pathlib.Path(folder) / "tree"
    shutil.rmtree(tree, ignore_errors=True)
    for part in ("include", "src", "hal"):
        shutil.copytree(SOURCE / part, tree / part)
    new, touched = toy_law.add(tree, without)
    expect(len(new) == 1 and touched == {str(toy_law.LIST): 1}, f"the law touched {new} and {touched}")
    return tree


def check_whole_law(folder):
    tree = scratch(folder)
    for sources in ASKING:
        asking = tree / "asking.cpp"
        asking.write_text("".join(f'#include "{tree / source}"\n' for source in sources))
        done = compile_in(tree, "-fsyntax-only", asking)
        expect(done.returncode == 0, f"{', '.join(sources)} do not compile with the new law:\n{done.stderr[:2000]}")
    probe = tree / "probe.cpp"
    probe.write_text(PROBE + "".join(f'#include "{source}"\n' for source in sorted((tree / "src/control").glob("*.cpp"))))
    # What is not the folder's comes from the build.
    done = compile_in(tree, "-O0", probe, "-o", tree / "probe", BUILD / "src/libpneuservo_core.a", "-lfmt", "-lyaml-cpp", "-lz")
    expect(done.returncode == 0, f"the probe does not compile:\n{done.stderr[:2000]}")
    said = subprocess.run([tree / "probe"], capture_output=True, text=True, check=True).stdout.split("\n")
    for line in ("law pd_force", "law ppd2", "law toy", "key kind", "key toy_gain_V_per_m", "column toy_error_m",
                 "rig cylinder", "command 10", "term 0.25"):
        expect(line in said, f"expected '{line}' among {said}")
    expect("rig servo_table" not in said and "rig driven_axis" not in said, f"a law of one valve runs {said}")


def check_missing_pieces(folder):
    """A law for each piece that one may lack, all in one list: the compiler asks each for its own."""
    tree = scratch(folder)
    (tree / toy_law.HEADER).unlink()
    listed = (tree / toy_law.LIST).read_text()
    first = listed.count("#include <pneuservo/control/") - 1
    lines = []
    for number, piece in enumerate(toy_law.PIECES, first):
        name = "Lacks" + piece.title().replace(" ", "")
        text = toy_law.header(number, piece).replace("Toy", name)
        (tree / toy_law.HEADER).with_name(f"{name}.hpp").write_text(text)
        lines.append(toy_law.LINE.replace("toy_law", name))
    (tree / toy_law.LIST).write_text(listed.replace(toy_law.LINE, "".join(lines)))
    probe = tree / "probe.cpp"
    probe.write_text("#include <pneuservo/control/laws.hpp>\n")
    done = compile_in(tree, "-fsyntax-only", probe)
    expect(done.returncode != 0, "laws without their pieces compile")
    for piece, (_, words) in toy_law.PIECES.items():
        law = "Lacks" + piece.title().replace(" ", "") + "Law"
        asked = re.search(rf"is_a_law\(\) \[with L = (?:pneuservo::)?{law}\].*?error: static assertion failed: (a law has: [^\n]*)", done.stderr, re.DOTALL)
        expect(asked and words in asked[1], f"without {piece} the compiler does not ask for '{words}':\n{done.stderr[:4000]}")
        print(f"without {piece}: asked for")


def check_numbers(folder):
    for number, words in ((1, "redefinition of"), (4, "leaves out the next free number")):
        tree = scratch(folder)
        (tree / toy_law.HEADER).write_text(toy_law.header(number))
        probe = tree / "probe.cpp"
        probe.write_text("#include <pneuservo/control/laws.hpp>\n")
        done = compile_in(tree, "-fsyntax-only", probe)
        expect(done.returncode != 0 and words in done.stderr, f"LawAt<{number}>: {done.stderr[:500]}")


with tempfile.TemporaryDirectory() as folder:
    check_missing_pieces(folder)
    check_numbers(folder)
    check_whole_law(folder)
