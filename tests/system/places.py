# Toy additions to the program: for each kind of the table "Where to add what" of docs/architecture.md the edits that it takes.
"""An addition names its row in the table and the edits, each in a file that the row names. tests/system/places_test.py
makes them in a scratch copy; tools/house-figures counts their files."""
import pathlib
import re
from dataclasses import dataclass

import toy_law

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TABLE = SOURCE / "docs/architecture.md"


@dataclass(frozen=True)
class Edit:
    """Puts `text` behind `anchor`, a text that stands once in the file; without an anchor the file is new."""

    path: str
    text: str
    anchor: str = ""

    def make(self, root):
        file = root / self.path
        if not self.anchor:
            file.write_text(self.text, encoding="utf-8")
            return
        old = file.read_text(encoding="utf-8")
        if old.count(self.anchor) != 1:
            raise SystemExit(f"places: {self.path}: found {old.count(self.anchor)} times {self.anchor!r}, expected once; adapt tests/system/places.py")
        file.write_text(old.replace(self.anchor, self.anchor + self.text), encoding="utf-8")


@dataclass(frozen=True)
class Addition:
    kind: str  # the row's first cell
    name: str  # what stands for <name> there
    edits: tuple
    beside: tuple = ()  # files that the row names for what this addition does without, and why not

    def files(self):
        return sorted({edit.path for edit in self.edits})

    def named(self):
        """Files that the row of the table names, the addition's own for <name>."""
        row = next(line for line in TABLE.read_text(encoding="utf-8").splitlines() if line.startswith(f"| {self.kind} |"))
        words = re.findall(r"`([\w./<>*-]+)`|\]\(([\w./-]+)\)", row.replace("<name>", self.name).replace("<verb>", self.name))
        paths = {("docs/" + link) if link else word for word, link in words if link or re.search(r"/.*\.\w+$|/\w[\w-]*$", word)}
        return {path if (SOURCE / path).exists() or path in self.files() else "include/pneuservo/" + path for path in paths}


EFFECT = "include/pneuservo/elements/"
V_COLUMN = "OF_AXIS(double, v_mps, none, velocity_mps_)"
ADDITIONS = (
    Addition("effect", "toy_drag", (
        Edit(EFFECT + "motion_effects.hpp", '''
/// A toy: drag that is proportional to the speed.
template <class S> struct ToyDrag {
  S coefficient_Ns_per_m = S(0);
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"coefficient_Ns_per_m", "N s/m", 0, 1e6, "c of c v"}, p.coefficient_Ns_per_m...);
  }
};
''', "namespace pneuservo {\n"),
        Edit(EFFECT + "motion_effects.hpp", "\n  ToyDrag<S> toy_drag;", "  QuadraticDrag<S> quadratic_drag;"),
        Edit(EFFECT + "motion_effects.hpp", '\n    v(Field{"toy_drag", "", 0, 0, "drag of a toy", optional}, p.toy_drag...);',
             '    v(Field{"constant_force", "", 0, 0, "constant load", optional}, p.constant_force...);'),
        Edit(EFFECT + "slider.hpp", " effects_.toy_drag.coefficient_Ns_per_m +", "    return viscous_ +"),
        Edit("docs/physics/effects.md", "\n| `toy_drag` | `c v` | `coefficient_Ns_per_m` |",
             "| `coulomb_friction` | `F sign(v)`; holds at rest up to F | `force_N` |"),
        Edit("src/elements/motion_effects.cpp", '''
    {.name = "toy_drag",
     .words = "a toy's drag that is proportional to the speed",
     .element = "motion",
     .family = "friction",
     .parameters = {amplitude("coefficient_Ns_per_m", force_per_speed, 0.03, 1e-4)},
     .shown_by = many_speeds,
     .smallest = {{"coefficient_Ns_per_m", 1}},
     .signatures = {{.sizes = {{"coefficient_Ns_per_m", 20}},
                     .words = "A straight line through zero.",
                     .channels = {F},
                     .against = "speed"}}},''', "constexpr EffectEntry motion_entries[] = {"),
    ), beside=(EFFECT + "effects.hpp", EFFECT + "line_ends.hpp", "src/elements/effects.cpp")),
    Addition("column of a recording", "toy_mps", (
        Edit("include/pneuservo/record/row.hpp", " COLUMN(double, toy_mps, none, 2.0 * velocity_mps_)", V_COLUMN),
    ), beside=("include/pneuservo/core/signal.hpp",)),
    Addition("verb", "toy", (
        Edit("src/program/toy.cpp", '''// Verb `toy`: says so.
#include <cstdio>

#include "program/verbs.hpp"

namespace pneuservo {

void add_toy(CommandLine& app, int& status) {
  app.add_verb("toy", "a toy of the test of places").callback([&status] { status = std::puts("a toy") < 0; });
}

}  // namespace pneuservo
'''),
        Edit("src/program/verbs.cpp", " add_toy,", "\nAddsVerb"),
        Edit("src/program/verbs.cpp", " {add_toy, reference},", "{add_command, running},"),
    )),
    # law_place_test.py compiles its dispatch and what it lacks.
    Addition("control law", "toy_law", (
        Edit(str(toy_law.HEADER), toy_law.header(3)),
        Edit(str(toy_law.LIST), "\n" + toy_law.LINE.strip(), "#include <pneuservo/control/pressure_pi.hpp>"),
    ), beside=("include/pneuservo/control/law.hpp", "docs/physics", "src/design/sampled_laws.hpp", "src/config/rig_checks.cpp")),
)
