// Arrays of numpy and values of Python, into the library and out of it.
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "binding.hpp"
#include "config/number_text.hpp"

namespace pneuservo::python {
namespace {

std::string shape_text(const nb::ndarray<nb::ro>& array) {
  std::string text;
  for (std::size_t i = 0; i < array.ndim(); ++i) text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  return fmt::format("({}{})", text, array.ndim() == 1 ? "," : "");
}

[[noreturn]] void refuse_type(std::string_view call, std::string_view name, const std::string& found) {
  throw nb::type_error(fmt::format("{}: {}: found {}, expected an array of float64 with one axis, or a number: "
                                   "numpy.asarray(values, dtype=float) makes one",
                                   call, name, found)
                           .c_str());
}

/// numpy's numbers and arrays as Python's, wherever they stand in a document.
nb::object plain(nb::handle value) {
  if (nb::hasattr(value, "tolist")) return value.attr("tolist")();
  throw nb::type_error(
      fmt::format("changes: found {}, expected numbers, words, lists or dicts", type_text(value)).c_str());
}

std::string yaml_of(nb::handle given) {
  const nb::object value = nb::hasattr(given, "tolist") ? plain(given) : nb::borrow<nb::object>(given);
  if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
  if (nb::isinstance<nb::dict>(value) || nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value) ||
      nb::isinstance<nb::bool_>(value))
    return nb::cast<std::string>(
        nb::module_::import_("json").attr("dumps")(value, nb::arg("default") = nb::cpp_function(&plain)));
  if (nb::isinstance<nb::int_>(value)) return nb::cast<std::string>(nb::str(value));
  double number = 0.0;
  if (!nb::try_cast(value, number))
    throw nb::type_error(
        fmt::format("changes: found {}, expected numbers, words, lists or dicts", type_text(value)).c_str());
  return number_text(number);
}

/// A key or PATH=VALUE of changes.
std::string text_of(nb::handle value, const char* expected) {
  if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
  throw nb::type_error(fmt::format("changes: found {}, expected {}", type_text(value), expected).c_str());
}

/// What an array or another object has in place of float64.
std::string element_text(nb::handle value) {
  if (!nb::hasattr(value, "dtype")) return type_text(value);
  const auto text = nb::cast<std::string>(nb::str(nb::object(value.attr("dtype"))));
  return text == "float64" ? "float64 at uneven places" : text;
}

/// A mask says which values count, and no column can.
void refuse_masked(nb::handle array, std::string_view call, std::string_view name) {
  if (!nb::hasattr(array, "filled") || !nb::hasattr(array, "mask")) return;
  if (nb::cast<bool>(nb::bool_(nb::object(array.attr("mask").attr("any")()))))
    throw nb::value_error(fmt::format("{}: {}: found masked values, expected an array without a mask: "
                                      "values.filled(numpy.nan) makes one",
                                      call, name)
                              .c_str());
}

}  // namespace

std::string type_text(nb::handle value) { return nb::cast<std::string>(nb::str(value.type().attr("__name__"))); }

void require_finite(std::string_view call, std::string_view name, double value) {
  if (!std::isfinite(value))
    throw nb::value_error(fmt::format("{}: {}: found {}, expected a finite number", call, name, value).c_str());
}

Column::Column(nb::handle values, std::string_view call, std::string_view name) : name_(name) {
  if (PyFloat_Check(values.ptr()) || PyLong_Check(values.ptr())) {
    number_ = nb::cast<double>(values);
    return;
  }
  // A column of a data frame gives its own memory.
  const nb::object given = nb::hasattr(values, "to_numpy") ? values.attr("to_numpy")() : nb::borrow<nb::object>(values);
  if (!nb::try_cast(given, array_, false)) refuse_type(call, name, element_text(values));
  refuse_masked(given, call, name);
  if (array_.dtype() != nb::dtype<double>())
    refuse_type(call, name, nb::cast<std::string>(nb::str(nb::object(given.attr("dtype")))));
  if (array_.ndim() != 1)
    throw nb::value_error(
        fmt::format("{}: {}: found the shape {}, expected one axis: (rows,)", call, name, shape_text(array_)).c_str());
  rows_ = array_.shape(0);
  stride_ = array_.stride(0);
  data_ = static_cast<const double*>(array_.data());
  static constexpr double no_row = 0.0;
  if (rows_ == 0) data_ = &no_row;
}

void Column::require_finite(std::string_view call) const {
  if (is_number()) return python::require_finite(call, name_, number_);
  for (std::size_t row = 0; row < rows_; ++row)
    if (!std::isfinite((*this)[row]))
      throw nb::value_error(
          fmt::format("{}: {}: found {} in row {}, expected finite numbers", call, name_, (*this)[row], row).c_str());
}

std::size_t common_rows(std::string_view call, std::initializer_list<const Column*> columns) {
  const Column* first = nullptr;
  for (const Column* column : columns) {
    if (column->is_number()) continue;
    if (first == nullptr) first = column;
    if (column->rows() != first->rows())
      throw nb::value_error(fmt::format("{}: {}: found {} rows, expected {} as {} has", call, column->name(),
                                        column->rows(), first->rows(), first->name())
                                .c_str());
  }
  if (first == nullptr) throw nb::value_error(fmt::format("{}: found numbers alone, expected an array", call).c_str());
  return first->rows();
}

namespace {

template <class T> nb::object owned_array(std::vector<T>&& values) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, T, nb::ndim<1>>(owned->data(), {owned->size()}, owner));
}

}  // namespace

FloatArray array_of(std::vector<double>&& values) { return nb::borrow<FloatArray>(owned_array(std::move(values))); }
nb::object array_of(std::vector<std::uint32_t>&& values) { return owned_array(std::move(values)); }

FloatArray view_of(const double* values, std::size_t rows, std::ptrdiff_t stride, nb::handle owner) {
  return nb::borrow<FloatArray>(
      nb::cast(nb::ndarray<nb::numpy, const double, nb::ndim<1>>(values, {rows}, owner, {stride})));
}

std::vector<std::string> overrides_of(nb::handle changes) {
  std::vector<std::string> out;
  if (changes.is_none()) return out;
  if (!nb::hasattr(changes, "items")) {
    if (nb::isinstance<nb::str>(changes) || !nb::hasattr(changes, "__iter__"))
      throw nb::type_error(
          fmt::format("changes: found {}, expected a dict or a list of PATH=VALUE", type_text(changes)).c_str());
    for (const nb::handle one : changes) out.push_back(text_of(one, "PATH=VALUE as text"));
    return out;
  }
  for (const nb::handle item : nb::object(changes.attr("items")()))
    out.push_back(text_of(nb::object(item[0]), "a config path as text") + "=" + yaml_of(nb::object(item[1])));
  return out;
}

nb::object python_value(const ConfigNode& node) {
  switch (node.type) {
    case ConfigNode::Type::nothing: return nb::none();
    case ConfigNode::Type::list: {
      nb::list out;
      for (const ConfigNode& item : node.items) out.append(python_value(item));
      return out;
    }
    case ConfigNode::Type::map: {
      nb::dict out;
      for (const ConfigNode::Entry& entry : node.entries) out[nb::cast(entry.key)] = python_value(entry.value);
      return out;
    }
    case ConfigNode::Type::scalar: break;
  }
  if (!node.quoted && (node.text == "true" || node.text == "false")) return nb::cast(node.text == "true");
  if (const auto number = node.quoted ? std::nullopt : number_from_text(node.text)) {
    if (node.text.find_first_not_of("0123456789") == std::string::npos) return nb::cast(std::stoull(node.text));
    return nb::cast(*number);
  }
  return nb::cast(node.text);
}

InUse::InUse(std::atomic<bool>& flag, const char* what) : flag_(flag) {
  if (flag.exchange(true, std::memory_order_acquire))
    throw std::runtime_error(fmt::format("{}: found in use by another thread, expected one thread at a time: make one "
                                         "for each thread",
                                         what));
}

}  // namespace pneuservo::python
