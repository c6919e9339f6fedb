// The one declaration of a parameter: key, unit, range, help; visited by YAML reader, dump, manual page, lane packing.
#pragma once
#include <limits>
#include <span>
#include <string_view>

#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// Whether a config must name the key. The default of an optional key is the member's initialiser, nowhere else.
enum class Presence { required, optional };

/// What is known of one parameter. `minimum` and `maximum` are inclusive; `choices` names the values of an enum.
struct Field {
  std::string_view key;
  std::string_view unit;
  double minimum = -infinite;
  double maximum = infinite;
  std::string_view help;
  Presence presence = Presence::required;
  std::span<const std::string_view> choices{};
  /// Other words for the first choices, which older configs use.
  std::span<const std::string_view> older_words{};
};

// A parameter struct P<S> declares its fields once:
//
//   template <class V, class... P> static void visit(V&& v, P&... p) {
//     v(Field{"length_m", "m", 0.01, 100.0, "port to port"}, p.length_m...);
//   }
//
// With one object it reads, writes or documents; with two it copies between scalars (cast, set_lane below).

/// Copies parameters between scalar types: every number is converted, anything else assigned.
struct CastVisitor {
  template <class To, class From> void operator()(const Field&, To& to, const From& from) const {
    if constexpr (std::is_same_v<To, From>) to = from;
    else if constexpr (std::is_arithmetic_v<From>) to = To(from);
    else to = cast_nested<To>(from);
  }
  template <class To, class From> static To cast_nested(const From& from) {
    To out{};
    To::visit(CastVisitor{}, out, from);
    return out;
  }
};

/// Parameters of scalar From (a built-in type) as parameters of another scalar, the same value in all lanes.
template <class To, class From> To cast(const From& from) { return CastVisitor::cast_nested<To>(from); }

/// Puts the numbers of a plain parameter struct into one lane of a packed one.
struct LaneVisitor {
  int index;
  template <class To, class From> void operator()(const Field&, To& to, const From& from) const {
    if constexpr (std::is_arithmetic_v<From> && !std::is_arithmetic_v<To>) set_lane(to, index, from);
    else if constexpr (!std::is_same_v<To, From>) To::visit(*this, to, from);
  }
};
template <class To, class From> void set_parameters_lane(To& to, int index, const From& from) {
  To::visit(LaneVisitor{index}, to, from);
}

}  // namespace pneuservo
