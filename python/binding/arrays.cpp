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

std::string type_text(nb::handle value) { return nb::cast<std::string>(nb::str(value.type().attr("__name__"))); }

[[noreturn]] void refuse_type(std::string_view call, std::string_view name, const std::string& found) {
  throw nb::type_error(fmt::format("{}: {}: found {}, expected an array of float64 with one axis, or a number: "
                                   "numpy.asarray(values, dtype=float) makes one",
                                   call, name, found)
                           .c_str());
}

std::string yaml_of(nb::handle value) {
  if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
  if (nb::isinstance<nb::dict>(value) || nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value) ||
      nb::isinstance<nb::bool_>(value))
    return nb::cast<std::string>(nb::module_::import_("json").attr("dumps")(value));
  if (nb::isinstance<nb::int_>(value)) return nb::cast<std::string>(nb::str(value));
  double number = 0.0;
  if (!nb::try_cast(value, number))
    throw nb::type_error(
        fmt::format("changes: found {}, expected numbers, words, lists or dicts", type_text(value)).c_str());
  return number_text(number);
}

}  // namespace

Column::Column(nb::handle values, std::string_view call, std::string_view name) : name_(name) {
  if (PyFloat_Check(values.ptr()) || PyLong_Check(values.ptr())) {
    number_ = nb::cast<double>(values);
    return;
  }
  // A column of a data frame gives its own memory.
  const nb::object given = nb::hasattr(values, "to_numpy") ? values.attr("to_numpy")() : nb::borrow<nb::object>(values);
  if (!nb::try_cast(given, array_, false)) refuse_type(call, name, type_text(values));
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

nb::object array_of(std::vector<double>&& values) { return owned_array(std::move(values)); }
nb::object array_of(std::vector<std::uint32_t>&& values) { return owned_array(std::move(values)); }

nb::object view_of(const double* values, std::size_t rows, std::ptrdiff_t stride, nb::handle owner) {
  return nb::cast(nb::ndarray<nb::numpy, const double, nb::ndim<1>>(values, {rows}, owner, {stride}));
}

std::vector<std::string> overrides_of(nb::handle changes) {
  std::vector<std::string> out;
  if (changes.is_none()) return out;
  if (!nb::hasattr(changes, "items")) {
    for (const nb::handle one : changes) out.push_back(nb::cast<std::string>(one));
    return out;
  }
  for (const nb::handle item : nb::object(changes.attr("items")()))
    out.push_back(nb::cast<std::string>(item[0]) + "=" + yaml_of(nb::object(item[1])));
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
