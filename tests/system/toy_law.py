# A small control law, and the one place where it is added to a tree: one new file and one line of the list.
import pathlib

HEADER = pathlib.Path("include/pneuservo/control/toy_law.hpp")
LIST = pathlib.Path("include/pneuservo/control/laws.hpp")
LINE = "#include <pneuservo/control/toy_law.hpp>\n"

# Each piece that a law must have: its text in the file, and the words with which the compiler asks for it.
PIECES = {
    "name": ('  static constexpr std::string_view name = "toy";\n', "static constexpr std::string_view name"),
    "valves": ("  static constexpr int valves = 1;\n", "static constexpr int valves"),
    "parameters": ("  using Parameters = ToyParameters;\n", "struct Parameters with visit"),
    "terms": ("  using Terms = ToyTerms;\n", "struct Terms with visit"),
    "configure": ("  void configure(const Parameters& parameters, const LawSetup&) { gain_V_per_m_ = parameters.toy_gain_V_per_m; }\n",
                  "configure(const Parameters&, const LawSetup&)"),
    "reset": ("  void reset(const std::array<double, 2>&) noexcept { terms_ = {}; }\n", "reset(const std::array<double, 2>&"),
    "skip": ("  void skip(std::int64_t) noexcept {}\n", "skip(std::int64_t periods)"),
    "step": ("""  ControlOutput step(const ControlInput& in) noexcept {
    terms_.error_m = in.now.d[0] - in.x_m;
    return {{gain_V_per_m_ * terms_.error_m, 0.0}, 0.0};
  }
""", "ControlOutput step(const ControlInput&)"),
    "recorded terms": ("  const ToyTerms& terms() const noexcept { return terms_; }\n", "const Terms& terms() const"),
}

TEXT = """// A proportional law: one command in proportion to the position error.
#pragma once
#include <pneuservo/control/law.hpp>

namespace pneuservo {{

struct ToyParameters {{
  double toy_gain_V_per_m = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {{
    v(Field{{"toy_gain_V_per_m", "V/m", 0, 1e9, "command per position error"}}, p.toy_gain_V_per_m...);
  }}
}};

struct ToyTerms {{
  double error_m = 0.0;
  template <class V, class... T> static constexpr void visit(V&& v, T&... t) {{
    v(LawTerm{{"toy_error_m", "m", "x_ref - x"}}, t.error_m...);
  }}
}};

class ToyLaw {{
 public:
{pieces}
 private:
  double gain_V_per_m_ = 0.0;
  ToyTerms terms_;
}};

template <> struct LawAt<{number}> {{
  using Law = ToyLaw;
}};

}}  // namespace pneuservo
"""


def header(number, without=None):
    """The new file's text; `without` leaves one of PIECES out."""
    return TEXT.format(number=number, pieces="".join(text for name, (text, _) in PIECES.items() if name != without))


def add(root, without=None):
    """Adds the law to the tree at `root`; returns the new files and the number of lines added to each old one."""
    root = pathlib.Path(root)
    listed = (root / LIST).read_text().splitlines(keepends=True)
    laws = [i for i, line in enumerate(listed) if line.startswith("#include <pneuservo/control/")]
    (root / HEADER).write_text(header(len(laws), without))
    listed.insert(laws[-1] + 1, LINE)
    (root / LIST).write_text("".join(listed))
    return [str(HEADER)], {str(LIST): 1}
