// Equality of parameter structs and rigs, value by value, through the fields they declare.
#pragma once
#include <algorithm>
#include <map>
#include <string>

#include <pneuservo/rig/rig.hpp>

#include "config/section_reader.hpp"

namespace pneuservo {

template <ParameterSection P> bool same_section(const P& a, const P& b);
bool same_reference(const ReferenceSpec& a, const ReferenceSpec& b);

/// Compares the pair of values of each field.
struct FieldComparer {
  bool& same;
  template <class T> void operator()(const Field&, const T& a, const T& b) const { same = same && equal(a, b); }

 private:
  template <class T> static bool equal(const T& a, const T& b) {
    if constexpr (std::is_same_v<T, ReferenceSpec>) return same_reference(a, b);
    else if constexpr (ParameterSection<T>) return same_section(a, b);
    else return a == b;
  }
  static bool equal(const std::vector<ReferenceSpec>& a, const std::vector<ReferenceSpec>& b) {
    bool same = a.size() == b.size();
    for (std::size_t i = 0; same && i < a.size(); ++i) same = same_reference(a[i], b[i]);
    return same;
  }
  template <ParameterSection T>
  static bool equal(const std::map<std::string, T>& a, const std::map<std::string, T>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& left, const auto& right) {
      return left.first == right.first && same_section(left.second, right.second);
    });
  }
  template <ParameterSection T> static bool equal(const std::optional<T>& a, const std::optional<T>& b) {
    return a.has_value() == b.has_value() && (!a || same_section(*a, *b));
  }
};

template <ParameterSection P> bool same_section(const P& a, const P& b) {
  bool same = true;
  P::visit(FieldComparer{same}, a, b);
  return same;
}

/// Whether two rigs say the same, effects of the sensors and reference included.
bool same_rig(const Rig& a, const Rig& b);

}  // namespace pneuservo
