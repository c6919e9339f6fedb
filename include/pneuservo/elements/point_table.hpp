// A function given by eight points: what stands for a law that nobody has written down.
#pragma once
#include <array>
#include <cstddef>
#include <string_view>

#include <pneuservo/core/field.hpp>
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// Places in ascending order and a value at each. Between them along straight lines, outside as at the nearest.
template <class S> struct PointTable {
  static constexpr std::size_t points = 8;
  std::array<S, points> place{}, value{};

  S at(const S& x) const noexcept {
    S out = value[0];
    for (std::size_t i = 0; i + 1 < points; ++i) {
      const S step = maximum(place[i + 1] - place[i], S(1e-30));
      out += (value[i + 1] - value[i]) * clamp((x - place[i]) / step, S(0), S(1));
    }
    return out;
  }
  bool is_there() const noexcept {
    bool out = false;
    for (const S& one : value) out = out || any(!(one == S(0)));
    return out;
  }
};

/// How the points of a table are called in a config, and what they may be.
struct TableKeys {
  std::array<std::string_view, PointTable<double>::points> places, values;
  Field place, value;  ///< unit, range and words of each

  template <class V, class... P> void visit(V&& v, P&... table) const {
    for (std::size_t i = 0; i < places.size(); ++i) v(named(place, places[i]), table.place[i]...);
    for (std::size_t i = 0; i < values.size(); ++i) v(named(value, values[i]), table.value[i]...);
  }

 private:
  static constexpr Field named(Field field, std::string_view key) {
    field.key = key;
    return field;
  }
};

}  // namespace pneuservo
