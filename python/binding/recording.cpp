// Recordings: read from files, made from arrays, written; foreign files by the importer.
#include <fmt/format.h>

#include "binding.hpp"
#include "config/dump_rig.hpp"
#include "config/input_error.hpp"
#include "diagnosis/doubts/import_result.hpp"
#include "record/import.hpp"
#include "record/row_text.hpp"
#include "record/writer.hpp"

namespace pneuservo::python {
namespace {

std::vector<Recording> read(const std::string& path, const Config* config) {
  const nb::gil_scoped_release released;
  return read_recordings(path, config == nullptr ? std::nullopt : config->rig.imported,
                         config == nullptr ? none : config->rig.period_s);
}

void fill(Recording& out, const nb::handle columns) {
  if (!nb::hasattr(columns, "items"))
    throw nb::type_error(
        fmt::format("Recording: found {}, expected a file, a Recording, or a mapping of columns", type_text(columns))
            .c_str());
  for (const nb::handle item : nb::object(columns.attr("items")())) {
    const nb::object key = item[0];
    if (!nb::isinstance<nb::str>(key))
      throw nb::type_error(
          fmt::format("Recording: found {} as a column's name, expected text", type_text(key)).c_str());
    const auto name = nb::cast<std::string>(key);
    const nb::object values = item[1];
    const Column column(values, "Recording", name);
    if (column.is_number())
      throw nb::value_error(
          fmt::format("Recording: {}: found a number, expected an array of shape (rows,)", name).c_str());
    if (!out.values.empty() && column.rows() != out.values.front().size())
      throw nb::value_error(fmt::format("Recording: {}: found {} rows, expected {} as {} has", name, column.rows(),
                                        out.values.front().size(), out.names.front())
                                .c_str());
    std::vector<double> kept(column.rows());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = column[i];
    out.names.push_back(name);
    out.values.push_back(std::move(kept));
  }
}

/// The arrays are copied once: a recording is the library's own.
void make(Recording* self, const nb::object& columns, double period_s, const std::string& rig, const std::string& name,
          const std::string& header_text) {
  Recording made;
  made.comments = header_text;
  made.path = name;
  made.rig = rig;
  made.period_s = period_s;
  fill(made, columns);
  made.require({"t_s"});
  const std::size_t rows = made.values.front().size();
  for (std::size_t i = 0; i < rows; ++i) made.line_numbers.push_back(i + 1);
  check_times(made);
  // A file's problems are told by whoever reads it; rows of arrays would go without a word.
  for (const std::string& line : problem_lines(made))
    if (PyErr_WarnEx(PyExc_UserWarning, line.c_str(), 1) != 0) throw nb::python_error();
  new (self) Recording(std::move(made));
}

FloatArray column(const nb::object& self, const std::string& name) {
  const auto& recording = nb::cast<const Recording&>(self);
  if (!recording.has(name)) {
    try {
      recording.require({name});
    } catch (const InputError& error) { throw nb::key_error(error.what()); }
  }
  const std::vector<double>& values = recording.column(name);
  return view_of(values.data(), values.size(), 1, self);
}

Document header(const Recording& recording) {
  try {
    const nb::object found = python_value(parse_config_tree(recording.comments, recording.path));
    if (nb::isinstance<nb::dict>(found)) return nb::borrow<Document>(found);
  } catch (const InputError&) {}  // a foreign file's comments are no keys
  return {};
}

/// Numbers of one row, each into the member that its column names.
class RowMaker {
 public:
  RowMaker(const Recording& recording, std::span<const std::string_view> terms) : terms_(terms) {
    Row::visit_all(terms, [&](std::string_view name) {
      sources_.push_back(recording.has(name) ? &recording.column(name) : nullptr);
    });
  }
  Row at(std::size_t row) const {
    Row out;
    std::size_t column = 0;
    Row::visit_all(
        terms_,
        [&]<class T>(std::string_view, T& value) {
          const std::vector<double>* source = sources_[column++];
          if (source != nullptr) value = static_cast<T>((*source)[row]);
        },
        out);
    return out;
  }

 private:
  std::span<const std::string_view> terms_;
  std::vector<const std::vector<double>*> sources_;
};

void write(const Recording& recording, const std::filesystem::path& path, const Config& config, bool replace) {
  const nb::gil_scoped_release released;
  const auto terms = law_columns(config.rig.controller.kind);
  RecordingHeader header(config.rig.name, config.rig.period_s);
  header.add_text("config", dump_rig(config.rig));
  RecordingWriter writer(path.string(), header, recording.names,
                         {.existing = replace ? ExistingFile::replace : ExistingFile::refuse, .terms = terms});
  const RowMaker rows(recording, terms);
  for (std::size_t i = 0; i < recording.rows(); ++i) writer.write(rows.at(i));
  if (const RecordingSummary summary = writer.close(); !summary.error.empty()) throw InputError(summary.error);
}

Documents guesses(const ImportResult& result) {
  Documents out;
  for (const ColumnGuess& guess : result.columns) {
    nb::dict one;
    one["column"] = guess.column;
    one["taken_for"] = guess.ours;
    one["unit"] = guess.unit;
    one["factor"] = guess.factor;
    one["offset"] = guess.offset;
    one["evidence"] = guess.evidence;
    out.append(one);
  }
  return out;
}

ImportResult understand(const std::filesystem::path& path, const Config* config) {
  const nb::gil_scoped_release released;
  return understand_recording(path.string(), config == nullptr ? std::nullopt : std::optional(config->rig));
}

}  // namespace

void bind_recording(nb::module_& m) {
  nb::class_<Recording>(m, "Recording", "Columns by name, a row a time, as a file or arrays gave them.")
      .def("__init__", &make, nb::arg("columns"), nb::arg("period_s") = none, nb::arg("rig") = "",
           nb::arg("name") = "memory", nb::arg("header_text") = "",
           "From a mapping (or DataFrame) of columns of float64 of shape (rows,), one of them t_s [s], rising.\n"
           "header_text: YAML that header gives as keys.")
      .def("__getitem__", &column, nb::arg("column"), "One column of shape (rows,), a view that cannot be written to.")
      .def("__contains__", [](const Recording& r, const std::string& name) { return r.has(name); })
      .def("__len__", [](const Recording& r) { return r.rows(); })
      .def(
          "keys", [](const Recording& r) { return r.names; }, "Names of the columns.")
      .def("write", &write, nb::arg("path"), nb::arg("config"), nb::arg("replace") = false,
           "Writes NAME.csv.gz in the format of docs/recording.md; numbers read back to the same bits.")
      .def_prop_ro("header", &header, "The keys of the file's header; empty: none, or made from arrays.")
      .def_ro("header_text", &Recording::comments, "The header as it stands in the file, without its signs of comment.")
      .def_prop_ro(
          "problems", [](const Recording& r) { return problem_lines(r); },
          "What is wrong with the file, one sentence each.")
      .def_prop_ro(
          "sources",
          [](const Recording& r) {
            Document out;
            for (const auto& [ours, source] : r.sources) out[nb::cast(ours)] = source.column;
            return out;
          },
          "Columns of a foreign file by ours.")
      .def_ro("rig", &Recording::rig)
      .def_ro("path", &Recording::path)
      .def_ro("period_s", &Recording::period_s, "Interval of the rows [s]; NaN: not known.");
  nb::class_<ImportResult>(m, "ImportResult", "What is understood of a foreign recording.")
      .def_ro("runs", &ImportResult::runs, nb::rv_policy::reference_internal, "Recordings in SI.")
      .def_ro("understood", &ImportResult::understood, "Dialect, times, rows that are not used, one sentence each.")
      .def_ro("doubts", &ImportResult::doubts, "Of the config's physics; empty without a config.")
      .def_ro("section", &ImportResult::section, "The section import: of a config that reads it so.")
      .def_prop_ro("columns", &guesses, "What each column is taken for, and by what.");
  m.def("read_recordings", &read, nb::arg("path"), nb::arg("config").none() = nb::none(),
        "The runs of one file, foreign ones by the config's section import. Raises InputError.");
  m.def("import_recording", &understand, nb::arg("path"), nb::arg("config").none() = nb::none(),
        "The verb import: a table of any logger, by the names and units of its columns.");
}

}  // namespace pneuservo::python
