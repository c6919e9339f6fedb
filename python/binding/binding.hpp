// What the files of the binding share: the config as an object, and arrays that go through without a copy.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <pneuservo/rig/rig.hpp>

#include "config/config_tree.hpp"

namespace pneuservo::python {

namespace nb = nanobind;

/// A config that was read; it never changes, so that threads may share it.
struct Config {
  Rig rig;
  std::string source;  ///< file or name that its errors state
};

/// The config, whose rig has proportional valves. Throws InputError for another one; `who` works on no other.
const Config& pneumatic(const Config& config, const char* who);

/// What a stub says of objects that this binding makes or looks into itself.
inline bool is_anything(PyObject*) noexcept { return true; }
struct Anything : nb::object {
  NB_OBJECT(Anything, nb::object, "typing.Any", is_anything)
};
struct ArrayOrNumber : nb::object {
  NB_OBJECT(ArrayOrNumber, nb::object, "numpy.ndarray[dtype=float64] | float", is_anything)
};
struct FloatArray : nb::object {
  NB_OBJECT_DEFAULT(FloatArray, nb::object, "numpy.ndarray[dtype=float64]", is_anything)
};
struct Columns : nb::dict {
  NB_OBJECT_DEFAULT(Columns, nb::dict, "dict[str, numpy.ndarray[dtype=float64]]", PyDict_Check)
};
struct Document : nb::dict {
  NB_OBJECT_DEFAULT(Document, nb::dict, "dict[str, typing.Any]", PyDict_Check)
};

struct Matrices : nb::tuple {
  NB_OBJECT_DEFAULT(Matrices, nb::tuple,
                    "tuple[numpy.ndarray[dtype=float64], numpy.ndarray[dtype=float64], numpy.ndarray[dtype=float64], "
                    "numpy.ndarray[dtype=float64]]",
                    PyTuple_Check)
};
struct Documents : nb::list {
  NB_OBJECT_DEFAULT(Documents, nb::list, "list[dict[str, typing.Any]]", PyList_Check)
};
struct Recordings : nb::list {
  NB_OBJECT_DEFAULT(Recordings, nb::list, "list[pneuservo._core.Recording]", PyList_Check)
};

/// The config's rig, with the formula where it has no command pass and goes on without one. Throws InputError where it
/// does not.
Rig with_pass_heeded(const Config& config);

/// One axis of float64 values of the caller's, read where they lie; a single number stands for every row.
class Column {
 public:
  /// `call` and `name` are for the sentences. Throws TypeError and ValueError as Python knows them.
  Column(nb::handle values, std::string_view call, std::string_view name);
  double operator[](std::size_t row) const noexcept {
    return data_ == nullptr ? number_ : data_[static_cast<std::ptrdiff_t>(row) * stride_];
  }
  bool is_number() const noexcept { return data_ == nullptr; }
  std::size_t rows() const noexcept { return rows_; }
  std::string_view name() const noexcept { return name_; }
  /// Throws ValueError where a value is not finite.
  void require_finite(std::string_view call) const;

 private:
  nb::ndarray<nb::ro> array_;  // holds the caller's memory
  std::string_view name_;
  const double* data_ = nullptr;
  double number_ = 0.0;
  std::size_t rows_ = 0;
  std::ptrdiff_t stride_ = 0;
};

/// An argument that is not given.
inline constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Rows that all columns have; throws ValueError where they differ or all are single numbers.
std::size_t common_rows(std::string_view call, std::initializer_list<const Column*> columns);

/// The values as an array of numpy that owns them; nothing is copied.
FloatArray array_of(std::vector<double>&& values);
nb::object array_of(std::vector<std::uint32_t>&& values);
/// Values that `owner` holds, `stride` doubles apart, as an array that cannot be written to.
FloatArray view_of(const double* values, std::size_t rows, std::ptrdiff_t stride, nb::handle owner);

/// Throws ValueError where a number is not finite.
void require_finite(std::string_view call, std::string_view name, double value);

/// Name of a value's type, for a sentence.
std::string type_text(nb::handle value);

/// A mapping of config paths to values, or a sequence of PATH=VALUE, as the program's --set states them.
std::vector<std::string> overrides_of(nb::handle changes);
/// Numbers, words, lists and dicts of a document.
nb::object python_value(const ConfigNode& node);

/// Held while a call runs without the interpreter's lock; a second thread in the same object is refused.
class InUse {
 public:
  InUse(std::atomic<bool>& flag, const char* what);
  ~InUse() { flag_.store(false, std::memory_order_release); }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  std::atomic<bool>& flag_;
};

void bind_config(nb::module_& m);
void bind_axis(nb::module_& m);
void bind_law(nb::module_& m);
void bind_recording(nb::module_& m);
void bind_work(nb::module_& m);
void bind_diagnosis(nb::module_& m);
void bind_design(nb::module_& m);

}  // namespace pneuservo::python
