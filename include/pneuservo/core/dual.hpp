// Dual<T, N>: a number with N derivatives (forward mode); T is a built-in scalar or a Pack.
#pragma once
#include <array>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// value + sum_i derivative[i] eps_i with eps_i eps_j = 0. Selections and comparisons look at the value alone.
template <class T, int N> struct Dual {
  T value{};
  std::array<T, N> derivative{};

  Dual() noexcept = default;
  Dual(const T& v) noexcept : value(v) {}  // NOLINT(google-explicit-constructor): a constant has no derivative
  template <class U, class = std::enable_if_t<std::is_arithmetic_v<U> && !std::is_same_v<U, T>>>
  Dual(U v) noexcept : value(T(v)) {}  // NOLINT(google-explicit-constructor)

  /// An independent variable: derivative 1 in direction i.
  static Dual variable(const T& v, int i) noexcept {
    Dual out(v);
    out.derivative[static_cast<std::size_t>(i)] = T(1);
    return out;
  }

  friend Dual operator+(const Dual& a, const Dual& b) noexcept { return chain(a.value + b.value, a, T(1), b, T(1)); }
  friend Dual operator-(const Dual& a, const Dual& b) noexcept { return chain(a.value - b.value, a, T(1), b, T(-1)); }
  friend Dual operator*(const Dual& a, const Dual& b) noexcept {
    return chain(a.value * b.value, a, b.value, b, a.value);
  }
  friend Dual operator/(const Dual& a, const Dual& b) noexcept {
    const T quotient = a.value / b.value;
    return chain(quotient, a, T(1) / b.value, b, -quotient / b.value);
  }
  friend Dual operator-(const Dual& a) noexcept { return chain(-a.value, a, T(-1)); }
  Dual& operator+=(const Dual& b) noexcept { return *this = *this + b; }
  Dual& operator-=(const Dual& b) noexcept { return *this = *this - b; }
  Dual& operator*=(const Dual& b) noexcept { return *this = *this * b; }
  Dual& operator/=(const Dual& b) noexcept { return *this = *this / b; }

  friend auto operator<(const Dual& a, const Dual& b) noexcept { return a.value < b.value; }
  friend auto operator<=(const Dual& a, const Dual& b) noexcept { return a.value <= b.value; }
  friend auto operator>(const Dual& a, const Dual& b) noexcept { return a.value > b.value; }
  friend auto operator>=(const Dual& a, const Dual& b) noexcept { return a.value >= b.value; }
  friend auto operator==(const Dual& a, const Dual& b) noexcept { return a.value == b.value; }

  /// Result with value v and derivatives da * a' + db * b'.
  static Dual chain(const T& v, const Dual& a, const T& da, const Dual& b, const T& db) noexcept {
    Dual out(v);
    for (std::size_t i = 0; i < N; ++i) out.derivative[i] = da * a.derivative[i] + db * b.derivative[i];
    return out;
  }
  static Dual chain(const T& v, const Dual& a, const T& da) noexcept {
    Dual out(v);
    for (std::size_t i = 0; i < N; ++i) out.derivative[i] = da * a.derivative[i];
    return out;
  }
};

template <class T, int N> struct ScalarTraits<Dual<T, N>> {
  using Mask = typename ScalarTraits<T>::Mask;
  using Real = typename ScalarTraits<T>::Real;
  static constexpr int lanes = ScalarTraits<T>::lanes;
  static constexpr bool packable = false;
};

template <class M, class T, int N> Dual<T, N> select(const M& mask, const Dual<T, N>& a, const Dual<T, N>& b) noexcept {
  Dual<T, N> out(select(mask, a.value, b.value));
  for (std::size_t i = 0; i < N; ++i) out.derivative[i] = select(mask, a.derivative[i], b.derivative[i]);
  return out;
}
template <class T, int N> Dual<T, N> minimum(const Dual<T, N>& a, const Dual<T, N>& b) noexcept {
  return select(a < b, a, b);
}
template <class T, int N> Dual<T, N> maximum(const Dual<T, N>& a, const Dual<T, N>& b) noexcept {
  return select(a > b, a, b);
}
template <class T, int N> Dual<T, N> absolute(const Dual<T, N>& a) noexcept { return select(a.value < T(0), -a, a); }
template <class T, int N> Dual<T, N> square_root(const Dual<T, N>& a) noexcept {
  const T root = square_root(a.value);
  // The slope at 0 is infinite; a value that is clamped to 0 has no direction, so its derivative is taken as 0.
  const T slope = select(root > T(0), T(0.5) / maximum(root, T(1e-150)), T(0));
  return Dual<T, N>::chain(root, a, slope);
}
template <class T, int N> Dual<T, N> fourth_root(const Dual<T, N>& a) noexcept {
  const T root = fourth_root(a.value);
  return Dual<T, N>::chain(root, a, T(0.25) * root / maximum(a.value, T(1e-30)));
}
template <class T, int N> Dual<T, N> exponential(const Dual<T, N>& a) noexcept {
  const T e = exponential(a.value);
  return Dual<T, N>::chain(e, a, e);
}
template <class T, int N> Dual<T, N> logarithm(const Dual<T, N>& a) noexcept {
  return Dual<T, N>::chain(logarithm(a.value), a, T(1) / a.value);
}
template <class T, int N> Dual<T, N> sine(const Dual<T, N>& a) noexcept {
  return Dual<T, N>::chain(sine(a.value), a, cosine(a.value));
}
template <class T, int N> Dual<T, N> cosine(const Dual<T, N>& a) noexcept {
  return Dual<T, N>::chain(cosine(a.value), a, -sine(a.value));
}
template <class T, int N> double largest(const Dual<T, N>& a) noexcept { return largest(a.value); }
template <class T, int N> double lane(const Dual<T, N>& a, int i) noexcept { return lane(a.value, i); }
template <class T, int N> void set_lane(Dual<T, N>& a, int i, double value) noexcept { set_lane(a.value, i, value); }

template <class T, int N> struct PairOf<Dual<T, N>> {
  using type = Dual<Pair<T>, N>;
};
template <class T, int N> auto join(const Dual<T, N>& a, const Dual<T, N>& b) noexcept {
  Pair<Dual<T, N>> out(join(a.value, b.value));
  for (std::size_t i = 0; i < N; ++i) out.derivative[i] = join(a.derivative[i], b.derivative[i]);
  return out;
}
template <class P, int N> auto low(const Dual<P, N>& a) noexcept {
  Dual<decltype(low(a.value)), N> out(low(a.value));
  for (std::size_t i = 0; i < N; ++i) out.derivative[i] = low(a.derivative[i]);
  return out;
}
template <class P, int N> auto high(const Dual<P, N>& a) noexcept {
  Dual<decltype(high(a.value)), N> out(high(a.value));
  for (std::size_t i = 0; i < N; ++i) out.derivative[i] = high(a.derivative[i]);
  return out;
}

}  // namespace pneuservo
