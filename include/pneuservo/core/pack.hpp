// Pack<T, N>: N lanes of a built-in floating-point type in SIMD registers, with the same rounding as the scalar type.
#pragma once
#include <cstdint>
#include <cstring>
#include <immintrin.h>
#include <type_traits>

#include <pneuservo/core/scalar.hpp>

namespace pneuservo {

/// Bytes of a native SIMD register of the target. A pack wider than that is split by us into whole registers: left to
/// the compiler, a 32-byte vector without AVX is taken apart lane by lane.
#if defined(__AVX__)
inline constexpr int native_register_bytes = 32;
#else
inline constexpr int native_register_bytes = 16;
#endif

namespace detail {
template <class T, int W> struct RegisterOf {
  typedef T type __attribute__((vector_size(W * sizeof(T))));
};
template <class T> using IntegerOf = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
template <class T, int N> constexpr int register_width() {
  const int native = native_register_bytes / static_cast<int>(sizeof(T));
  return N < native ? N : native;
}
}  // namespace detail

/// Lane mask of a Pack: all bits of a lane set (true) or none.
template <class T, int N> struct PackMask {
  static constexpr int width = detail::register_width<T, N>();
  static constexpr int registers = N / width;
  using Register = typename detail::RegisterOf<detail::IntegerOf<T>, width>::type;
  Register r[registers];

  bool operator[](int i) const noexcept { return r[i / width][i % width] != 0; }
  friend PackMask operator&(const PackMask& a, const PackMask& b) noexcept {
    PackMask out;
    for (int i = 0; i < registers; ++i) out.r[i] = a.r[i] & b.r[i];
    return out;
  }
  friend PackMask operator|(const PackMask& a, const PackMask& b) noexcept {
    PackMask out;
    for (int i = 0; i < registers; ++i) out.r[i] = a.r[i] | b.r[i];
    return out;
  }
  friend PackMask operator!(const PackMask& a) noexcept {
    PackMask out;
    for (int i = 0; i < registers; ++i) out.r[i] = ~a.r[i];
    return out;
  }
};

/// N lanes of T. N is 1, 2, 4, 8, ...; arithmetic, comparison and square root are the scalar operations lane by lane,
/// so that a lane computes bit for bit what the scalar program computes.
template <class T, int N> struct Pack {
  static_assert(std::is_floating_point_v<T> && N >= 2 && (N & (N - 1)) == 0);
  static constexpr int width = detail::register_width<T, N>();
  static constexpr int registers = N / width;
  using Register = typename detail::RegisterOf<T, width>::type;
  using MaskType = PackMask<T, N>;
  Register r[registers];

  Pack() noexcept { for (int i = 0; i < registers; ++i) r[i] = Register{}; }
  Pack(T value) noexcept {  // NOLINT(google-explicit-constructor): a constant stands for all lanes
    for (int i = 0; i < registers; ++i) r[i] = value - Register{};
  }
  template <class U, class = std::enable_if_t<std::is_arithmetic_v<U> && !std::is_same_v<U, T>>>
  Pack(U value) noexcept : Pack(static_cast<T>(value)) {}  // NOLINT(google-explicit-constructor)

  T operator[](int i) const noexcept { return r[i / width][i % width]; }
  void set(int i, T value) noexcept { r[i / width][i % width] = value; }

  /// Lanes from N consecutive values, aligned or not.
  static Pack load(const T* from) noexcept {
    Pack out;
    std::memcpy(out.r, from, sizeof(out.r));
    return out;
  }
  void store(T* to) const noexcept { std::memcpy(to, r, sizeof(r)); }

  friend Pack operator+(const Pack& a, const Pack& b) noexcept { return apply(a, b, [](auto x, auto y) { return x + y; }); }
  friend Pack operator-(const Pack& a, const Pack& b) noexcept { return apply(a, b, [](auto x, auto y) { return x - y; }); }
  friend Pack operator*(const Pack& a, const Pack& b) noexcept { return apply(a, b, [](auto x, auto y) { return x * y; }); }
  friend Pack operator/(const Pack& a, const Pack& b) noexcept { return apply(a, b, [](auto x, auto y) { return x / y; }); }
  friend Pack operator-(const Pack& a) noexcept {
    Pack out;
    for (int i = 0; i < registers; ++i) out.r[i] = -a.r[i];
    return out;
  }
  Pack& operator+=(const Pack& b) noexcept { return *this = *this + b; }
  Pack& operator-=(const Pack& b) noexcept { return *this = *this - b; }
  Pack& operator*=(const Pack& b) noexcept { return *this = *this * b; }
  Pack& operator/=(const Pack& b) noexcept { return *this = *this / b; }

  friend MaskType operator<(const Pack& a, const Pack& b) noexcept { return compare(a, b, [](auto x, auto y) { return x < y; }); }
  friend MaskType operator<=(const Pack& a, const Pack& b) noexcept { return compare(a, b, [](auto x, auto y) { return x <= y; }); }
  friend MaskType operator>(const Pack& a, const Pack& b) noexcept { return compare(a, b, [](auto x, auto y) { return x > y; }); }
  friend MaskType operator>=(const Pack& a, const Pack& b) noexcept { return compare(a, b, [](auto x, auto y) { return x >= y; }); }
  friend MaskType operator==(const Pack& a, const Pack& b) noexcept { return compare(a, b, [](auto x, auto y) { return x == y; }); }

  template <class F> static Pack apply(const Pack& a, const Pack& b, F f) noexcept {
    Pack out;
    for (int i = 0; i < registers; ++i) out.r[i] = f(a.r[i], b.r[i]);
    return out;
  }
  template <class F> static MaskType compare(const Pack& a, const Pack& b, F f) noexcept {
    MaskType out;
    for (int i = 0; i < registers; ++i) out.r[i] = f(a.r[i], b.r[i]);
    return out;
  }
  template <class F> static Pack each(const Pack& a, F f) noexcept {
    Pack out;
    for (int i = 0; i < N; ++i) out.set(i, f(a[i]));
    return out;
  }
};

template <class T, int N> struct ScalarTraits<Pack<T, N>> {
  using Mask = PackMask<T, N>;
  using Real = T;
  static constexpr int lanes = N;
  static constexpr bool packable = true;
};

template <class T, int N>
Pack<T, N> select(const PackMask<T, N>& mask, const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  Pack<T, N> out;
  for (int i = 0; i < Pack<T, N>::registers; ++i) out.r[i] = mask.r[i] ? a.r[i] : b.r[i];
  return out;
}
namespace detail {
// One bit a lane (doubles) or a byte (others): non-zero where any lane is set.
template <class R> int register_bits(R mask) noexcept {
  if constexpr (sizeof(R) == 16) return _mm_movemask_epi8(reinterpret_cast<__m128i>(mask));
#if defined(__AVX2__)
  else if constexpr (sizeof(R) == 32) return _mm256_movemask_epi8(reinterpret_cast<__m256i>(mask));
#endif
  else {
    int bits = 0;
    for (unsigned i = 0; i < sizeof(R) / sizeof(mask[0]); ++i) bits |= (mask[i] != 0) << i;
    return bits;
  }
}
}  // namespace detail

template <class T, int N> bool any(const PackMask<T, N>& mask) noexcept {
  auto sum = mask.r[0];
  for (int i = 1; i < PackMask<T, N>::registers; ++i) sum |= mask.r[i];
  return detail::register_bits(sum) != 0;
}
template <class T, int N> bool all(const PackMask<T, N>& mask) noexcept { return !any(!mask); }
template <class T, int N> int count(const PackMask<T, N>& mask) noexcept {
  int n = 0;
  for (int i = 0; i < N; ++i) n += mask[i] ? 1 : 0;
  return n;
}
template <class T, int N> Pack<T, N> minimum(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  return select(a < b, a, b);
}
template <class T, int N> Pack<T, N> maximum(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  return select(a > b, a, b);
}
template <class T, int N> Pack<T, N> absolute(const Pack<T, N>& a) noexcept { return select(a < Pack<T, N>(T(0)), -a, a); }

namespace detail {
template <class R> R register_square_root(R a) noexcept {
  if constexpr (std::is_same_v<R, typename RegisterOf<double, 2>::type>) {
    return reinterpret_cast<R>(_mm_sqrt_pd(reinterpret_cast<__m128d>(a)));
#if defined(__AVX__)
  } else if constexpr (std::is_same_v<R, typename RegisterOf<double, 4>::type>) {
    return reinterpret_cast<R>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(a)));
  } else if constexpr (std::is_same_v<R, typename RegisterOf<float, 8>::type>) {
    return reinterpret_cast<R>(_mm256_sqrt_ps(reinterpret_cast<__m256>(a)));
#endif
  } else if constexpr (std::is_same_v<R, typename RegisterOf<float, 4>::type>) {
    return reinterpret_cast<R>(_mm_sqrt_ps(reinterpret_cast<__m128>(a)));
  } else {
    for (unsigned i = 0; i < sizeof(R) / sizeof(a[0]); ++i) a[i] = std::sqrt(a[i]);
    return a;
  }
}
}  // namespace detail

template <class T, int N> Pack<T, N> square_root(const Pack<T, N>& a) noexcept {
  Pack<T, N> out;
  for (int i = 0; i < Pack<T, N>::registers; ++i) out.r[i] = detail::register_square_root(a.r[i]);
  return out;
}
template <class T, int N> Pack<T, N> exponential(const Pack<T, N>& a) noexcept {
  return Pack<T, N>::each(a, [](T x) { return std::exp(x); });
}
template <class T, int N> Pack<T, N> logarithm(const Pack<T, N>& a) noexcept {
  return Pack<T, N>::each(a, [](T x) { return std::log(x); });
}
template <class T, int N> Pack<T, N> sine(const Pack<T, N>& a) noexcept {
  return Pack<T, N>::each(a, [](T x) { return std::sin(x); });
}
template <class T, int N> Pack<T, N> cosine(const Pack<T, N>& a) noexcept {
  return Pack<T, N>::each(a, [](T x) { return std::cos(x); });
}
template <class T, int N> double largest(const Pack<T, N>& a) noexcept {
  T out = a[0];
  for (int i = 1; i < N; ++i) out = a[i] > out ? a[i] : out;
  return static_cast<double>(out);
}
template <class T, int N> double lane(const Pack<T, N>& a, int i) noexcept { return static_cast<double>(a[i]); }
template <class T, int N> void set_lane(Pack<T, N>& a, int i, double value) noexcept { a.set(i, static_cast<T>(value)); }

// --- both sides of an axis ---------------------------------------------------------------------
template <> struct PairOf<double> { using type = Pack<double, 2>; };
template <> struct PairOf<float> { using type = Pack<float, 2>; };
template <class T, int N> struct PairOf<Pack<T, N>> { using type = Pack<T, 2 * N>; };

inline Pack<double, 2> join(double a, double b) noexcept {
  Pack<double, 2> out;
  out.r[0] = typename Pack<double, 2>::Register{a, b};
  return out;
}
inline Pack<float, 2> join(float a, float b) noexcept {
  Pack<float, 2> out;
  out.r[0] = typename Pack<float, 2>::Register{a, b};
  return out;
}
inline double low(const Pack<double, 2>& a) noexcept { return a[0]; }
inline double high(const Pack<double, 2>& a) noexcept { return a[1]; }
inline float low(const Pack<float, 2>& a) noexcept { return a[0]; }
inline float high(const Pack<float, 2>& a) noexcept { return a[1]; }
template <class T, int N> Pack<T, 2 * N> join(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  T lanes[2 * N];
  a.store(lanes);
  b.store(lanes + N);
  return Pack<T, 2 * N>::load(lanes);
}
template <class T, int N> Pack<T, N / 2> low(const Pack<T, N>& a) noexcept {
  T lanes[N];
  a.store(lanes);
  return Pack<T, N / 2>::load(lanes);
}
template <class T, int N> Pack<T, N / 2> high(const Pack<T, N>& a) noexcept {
  T lanes[N];
  a.store(lanes);
  return Pack<T, N / 2>::load(lanes + N / 2);
}

}  // namespace pneuservo
