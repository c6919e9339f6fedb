// Keys of the section `import`: how recordings of a foreign format are read.
#pragma once
#include <array>
#include <map>
#include <string>
#include <string_view>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// What a column's value says of the time until the next row.
enum class Sampling {
  unstated,  ///< a command or drive force: held over a period of the loop; anything else: of its instant
  held,      ///< acts unchanged until the next row
  instant,   ///< read at the row's time; between rows it changed
};
inline constexpr std::array<std::string_view, 3> sampling_names{"unstated", "held", "instant"};

/// One column of a foreign recording: ours = factor theirs + offset.
struct ImportedColumn {
  std::string column;
  double factor = 1.0;
  double offset = 0.0;
  bool tells_runs = false;
  Sampling sampling = Sampling::unstated;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"column", "", 0, 0, "its name in the file"}, p.column...);
    v(Field{"factor", "-", -infinite, infinite, "ours = factor x theirs + offset", Presence::optional}, p.factor...);
    v(Field{"offset", "", -infinite, infinite, "in our column's unit", Presence::optional}, p.offset...);
    v(Field{"tells_runs", "", 0, 0, "rows with another value belong to another run", Presence::optional},
      p.tells_runs...);
    v(Field{"sampling", "", 0, 0, "of a command or force: held until the next row, or read at its instant",
            Presence::optional, sampling_names},
      p.sampling...);
  }
};

/// How a foreign recording is read: its columns under the names of the recording format.
struct ImportParameters {
  std::map<std::string, ImportedColumn> columns;
  double from_s = -infinite;
  double to_s = infinite;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"columns", "", 0, 0,
            "by the names of the recording format; columns that bear such a name are taken as they are unless named"},
      p.columns...);
    v(Field{"from_s", "s", -infinite, infinite, "earlier rows are left out", Presence::optional}, p.from_s...);
    v(Field{"to_s", "s", -infinite, infinite, "later rows are left out", Presence::optional}, p.to_s...);
  }
};

}  // namespace pneuservo
