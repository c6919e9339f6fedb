// The operations every scalar of the elements offers (double, float, Pack, Dual), given here for the built-in ones.
#pragma once
#include <cmath>
#include <limits>
#include <type_traits>

namespace pneuservo {

/// What an element may ask of its scalar S beside + - * / and comparisons: select (in place of branches, so that each
/// lane goes its own way), any, all, minimum, maximum, absolute, square_root, exponential, logarithm, sine, cosine.
/// Comparisons give Mask<S>: bool for built-in scalars, a lane mask for packs.
template <class S> struct ScalarTraits {
  static_assert(std::is_floating_point_v<S>, "specialise ScalarTraits for this scalar");
  using Mask = bool;
  using Real = S;                   ///< the built-in type underneath
  static constexpr int lanes = 1;   ///< independent values carried side by side
  static constexpr bool packable = true;  ///< consecutive elements in memory are plain Real values
};
template <class S> using Mask = typename ScalarTraits<S>::Mask;
template <class S> using Real = typename ScalarTraits<S>::Real;

inline double select(bool mask, double a, double b) noexcept { return mask ? a : b; }
inline float select(bool mask, float a, float b) noexcept { return mask ? a : b; }
inline bool any(bool mask) noexcept { return mask; }
inline bool all(bool mask) noexcept { return mask; }
inline int count(bool mask) noexcept { return mask ? 1 : 0; }

inline double minimum(double a, double b) noexcept { return a < b ? a : b; }
inline double maximum(double a, double b) noexcept { return a > b ? a : b; }
inline float minimum(float a, float b) noexcept { return a < b ? a : b; }
inline float maximum(float a, float b) noexcept { return a > b ? a : b; }
inline double absolute(double a) noexcept { return std::fabs(a); }
inline float absolute(float a) noexcept { return std::fabs(a); }
inline double square_root(double a) noexcept { return std::sqrt(a); }
inline float square_root(float a) noexcept { return std::sqrt(a); }
/// a^(1/4) for a >= 0 by square roots in single precision: relative error below 1e-7, at a third of the cost. For the
/// friction correlations, which are good to percents.
inline double fourth_root(double a) noexcept {
  return static_cast<double>(std::sqrt(std::sqrt(static_cast<float>(a))));
}
inline float fourth_root(float a) noexcept { return std::sqrt(std::sqrt(a)); }
inline double exponential(double a) noexcept { return std::exp(a); }
inline float exponential(float a) noexcept { return std::exp(a); }
inline double logarithm(double a) noexcept { return std::log(a); }
inline float logarithm(float a) noexcept { return std::log(a); }
inline double sine(double a) noexcept { return std::sin(a); }
inline float sine(float a) noexcept { return std::sin(a); }
inline double cosine(double a) noexcept { return std::cos(a); }
inline float cosine(float a) noexcept { return std::cos(a); }

/// Largest of the lanes, as a plain number (the sub-step count is common to all lanes).
inline double largest(double a) noexcept { return a; }
inline double largest(float a) noexcept { return static_cast<double>(a); }

/// Value of one lane; lane 0 of a built-in scalar is the scalar.
inline double lane(double a, int) noexcept { return a; }
inline double lane(float a, int) noexcept { return static_cast<double>(a); }
inline void set_lane(double& a, int, double value) noexcept { a = value; }
inline void set_lane(float& a, int, double value) noexcept { a = static_cast<float>(value); }

/// False for a NaN, lane by lane.
template <class S> Mask<S> is_number(const S& a) noexcept {
  return a == a;  // NOLINT(misc-redundant-expression): a NaN differs from itself
}

template <class S> S clamp(const S& value, const S& low, const S& high) noexcept {
  return minimum(maximum(value, low), high);
}

/// The scalar of twice the lanes that carries both sides of an axis: side 1 in the low half, side 2 in the high half.
/// Specialised beside each scalar; join(low, high), low(pair) and high(pair) convert.
template <class S> struct PairOf;
template <class S> using Pair = typename PairOf<S>::type;

}  // namespace pneuservo
