// Group<S>: neighbouring elements of a row of scalars side by side in one register, so that a loop along the row fills
// it.
#pragma once
#include <cstring>
#include <type_traits>
#include <utility>

#include <pneuservo/core/pack.hpp>

namespace pneuservo {

/// A pack that fills half a register or less is computed several elements at once, a plain double two (four would idle
/// more often at the end of a row, and shift in slower registers); every other scalar stands for itself. Element
/// operations are the same ones, so the numbers do not depend on the grouping.
template <class S> struct GroupOf {
  using type = S;
  static constexpr int elements = 1;
};
template <class T, int N> struct GroupOf<Pack<T, N>> {
  static constexpr int register_lanes = native_register_bytes / static_cast<int>(sizeof(T));
  static constexpr int elements = N < register_lanes ? register_lanes / N : 1;
  using type = Pack<T, N * elements>;
};
template <> struct GroupOf<double> {
  static constexpr int elements = 2;
  using type = Pack<double, elements>;
};
template <class S> using Group = typename GroupOf<S>::type;

namespace detail {
// Lanes from .. from + W - 1 of a and b laid end to end.
template <class R, int from, int... i> [[gnu::always_inline]] inline R
window(R a, R b, std::integer_sequence<int, i...>) noexcept {
  return __builtin_shufflevector(a, b, (from + i)...);
}
template <class R, int... i> [[gnu::always_inline]] inline auto repeated(R a,
                                                                         std::integer_sequence<int, i...>) noexcept {
  constexpr int lanes = static_cast<int>(sizeof(R) / sizeof(a[0]));
  return __builtin_shufflevector(a, a, (i % lanes)...);
}
}  // namespace detail

/// The element in all places of the group.
template <class S> [[gnu::always_inline]] inline Group<S> replicate(const S& element) noexcept {
  if constexpr (GroupOf<S>::elements == 1) {
    return element;
  } else if constexpr (ScalarTraits<S>::lanes == 1) {
    return Group<S>(element);
  } else {
    Group<S> out;
    out.r = detail::repeated(element.r, std::make_integer_sequence<int, ScalarTraits<Group<S>>::lanes>{});
    return out;
  }
}
/// The group that begins one element before `current`: last element of `previous`, then all but the last of `current`.
template <class S> [[gnu::always_inline]] inline Group<S> one_before(const Group<S>& previous,
                                                                     const Group<S>& current) noexcept {
  if constexpr (GroupOf<S>::elements == 1) {
    return previous;
  } else {
    constexpr int lanes = ScalarTraits<Group<S>>::lanes;
    Group<S> out;
    out.r = detail::window<decltype(out.r), lanes - ScalarTraits<S>::lanes>(previous.r, current.r,
                                                                            std::make_integer_sequence<int, lanes>{});
    return out;
  }
}
/// The group that begins one element after `current`: all but its first, then the first element of `next`.
template <class S> [[gnu::always_inline]] inline Group<S> one_after(const Group<S>& current,
                                                                    const Group<S>& next) noexcept {
  if constexpr (GroupOf<S>::elements == 1) {
    return next;
  } else {
    constexpr int lanes = ScalarTraits<Group<S>>::lanes;
    Group<S> out;
    out.r = detail::window<decltype(out.r), ScalarTraits<S>::lanes>(current.r, next.r,
                                                                    std::make_integer_sequence<int, lanes>{});
    return out;
  }
}
/// Element i of a row that is stored in groups.
template <class S> [[gnu::always_inline]] inline S element(const Group<S>& group, int i) noexcept {
  if constexpr (GroupOf<S>::elements == 1) {
    return group;
  } else {
    S out;
    std::memcpy(static_cast<void*>(&out),
                reinterpret_cast<const char*>(&group) + static_cast<std::size_t>(i) * sizeof out, sizeof out);
    return out;
  }
}
template <class S> [[gnu::always_inline]] inline void set_element(Group<S>& group, int i, const S& value) noexcept {
  if constexpr (GroupOf<S>::elements == 1) {
    group = value;
  } else {
    std::memcpy(reinterpret_cast<char*>(&group) + static_cast<std::size_t>(i) * sizeof value,
                static_cast<const void*>(&value), sizeof value);
  }
}
/// Mask of the places first .. elements - 1 of a group.
template <class S> inline Mask<Group<S>> places_from(int first) noexcept {
  using G = Group<S>;
  G place;
  for (int i = 0; i < ScalarTraits<G>::lanes; ++i) {
    const int element = i / ScalarTraits<S>::lanes;
    set_lane(place, i, static_cast<double>(element));
  }
  return place >= G(first);
}

}  // namespace pneuservo
