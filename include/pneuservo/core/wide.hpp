// Wide<S>: the register that takes several neighbouring elements of an array of S at once, so that a loop over cells
// uses all of a SIMD register even when S has one or two lanes.
#pragma once
#include <pneuservo/core/pack.hpp>
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// V is S itself (one element a step) or a Pack whose lanes are `step` neighbouring elements of S.
template <class S, class V> struct ElementStep {
  static constexpr int step = ScalarTraits<V>::lanes / ScalarTraits<S>::lanes;
};

namespace detail {
template <class S, bool packable> struct WideOf { using type = S; };
template <class S> struct WideOf<S, true> {
  using R = Real<S>;
  static constexpr int native = native_register_bytes / static_cast<int>(sizeof(R));
  using type = std::conditional_t<(ScalarTraits<S>::lanes >= native), S, Pack<R, native>>;
};
}  // namespace detail

/// The widest useful register for arrays of S on this target.
template <class S> using Wide = typename detail::WideOf<S, ScalarTraits<S>::packable>::type;

template <class V, class S> V load_wide(const S* from) noexcept {
  if constexpr (std::is_same_v<V, S>) return *from;
  else return V::load(reinterpret_cast<const Real<S>*>(from));
}
template <class V, class S> void store_wide(const V& value, S* to) noexcept {
  if constexpr (std::is_same_v<V, S>) *to = value;
  else value.store(reinterpret_cast<Real<S>*>(to));
}
/// The same S in every element of V.
template <class V, class S> V repeat(const S& value) noexcept {
  if constexpr (std::is_same_v<V, S>) {
    return value;
  } else {
    constexpr int lanes = ScalarTraits<S>::lanes;
    V out;
    for (int i = 0; i < ScalarTraits<V>::lanes; ++i) out.set(i, static_cast<Real<S>>(lane(value, i % lanes)));
    return out;
  }
}

/// Calls body(V{}, i) over i = 0..count-1 in steps of V's width; the last call overlaps the one before it when count is
/// not a multiple, so the body may read only what it does not write. Fewer elements than one step: element by element.
template <class V, class S, class F> void for_each_wide(int count, F&& body) noexcept {
  constexpr int step = ElementStep<S, V>::step;
  if constexpr (step > 1) {
    if (count < step) {
      for (int i = 0; i < count; ++i) body(S{}, i);
      return;
    }
    int i = 0;
    for (; i + step <= count; i += step) body(V{}, i);
    if (i < count) body(V{}, count - step);
  } else {
    for (int i = 0; i < count; ++i) body(V{}, i);
  }
}

}  // namespace pneuservo
