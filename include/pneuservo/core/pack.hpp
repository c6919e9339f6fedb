// Pack<T, N>: N lanes of a built-in floating-point type in SIMD registers, with the same rounding as the scalar type.
#pragma once
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <pneuservo/core/scalar.hpp>

// Instructions of x86; PNEUSERVO_PORTABLE_PACK shuts them out, so that a test can compare both ways on one machine.
#if defined(__SSE2__) && !defined(PNEUSERVO_PORTABLE_PACK)
#define PNEUSERVO_X86_PACK
#include <immintrin.h>
#endif

namespace pneuservo {

/// Bytes of a native SIMD register of the target. A pack wider than that is split by us into halves: left to the
/// compiler, a 32-byte vector without AVX is taken apart lane by lane, and an array of registers goes through memory.
#if defined(__AVX__)
inline constexpr int native_register_bytes = 32;
#else
inline constexpr int native_register_bytes = 16;
#endif

template <class T, int N> struct Pack;
template <class T, int N> struct PackMask;

namespace detail {
template <class T, int W> struct RegisterOf {
  typedef T type __attribute__((vector_size(W * sizeof(T))));
};
template <class T> using IntegerOf = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
template <class T, int N> inline constexpr bool single_register =
    N * static_cast<int>(sizeof(T)) <= native_register_bytes;

// One register, or two packs of half the lanes.
template <class Self, class Half, class RegisterType, bool single> struct PackData {
  RegisterType r;
};
template <class Self, class Half, class RegisterType> struct PackData<Self, Half, RegisterType, false> {
  Half low_half, high_half;
};
template <class T, int N> using PackBase =
    PackData<Pack<T, N>, Pack<T, N / 2>, typename RegisterOf<T, (single_register<T, N> ? N : 1)>::type,
             single_register<T, N>>;
template <class T, int N> using MaskBase =
    PackData<PackMask<T, N>, PackMask<T, N / 2>,
             typename RegisterOf<IntegerOf<T>, (single_register<T, N> ? N : 1)>::type, single_register<T, N>>;

// f applied register by register.
template <class Out, class F, class... In> [[gnu::always_inline]] inline Out map_registers(F f,
                                                                                           const In&... in) noexcept {
  Out out;
  if constexpr (Out::single) {
    out.r = f(in.r...);
  } else {
    using Half = decltype(out.low_half);
    out.low_half = map_registers<Half>(f, in.low_half...);
    out.high_half = map_registers<Half>(f, in.high_half...);
  }
  return out;
}

// Operations on one register that the vector extensions lack or compile badly. The templates serve every processor; the
// functions below them are the same operations, rounding included, as x86 instructions.

// Bits of a mask register: non-zero where any lane is set.
template <class R> inline int register_bits(R mask) noexcept {
  int bits = 0;
  for (unsigned i = 0; i < sizeof(R) / sizeof(mask[0]); ++i) bits |= (mask[i] != 0) << i;
  return bits;
}
template <class R> inline R register_square_root(R a) noexcept {
  for (unsigned i = 0; i < sizeof(R) / sizeof(a[0]); ++i) a[i] = std::sqrt(a[i]);
  return a;
}
// a < b ? a : b and a > b ? a : b: the second one where either is no number, as x86 defines them.
template <class R> inline R register_minimum(R a, R b) noexcept { return a < b ? a : b; }
template <class R> inline R register_maximum(R a, R b) noexcept { return a > b ? a : b; }
// By square roots in single precision, as fourth_root in scalar.hpp.
template <class R> inline R register_fourth_root(R a) noexcept {
  for (unsigned i = 0; i < sizeof(R) / sizeof(a[0]); ++i) a[i] = fourth_root(a[i]);
  return a;
}

#if defined(PNEUSERVO_X86_PACK)
using Double2 = RegisterOf<double, 2>::type;
using Float4 = RegisterOf<float, 4>::type;
inline int register_bits(RegisterOf<std::int64_t, 2>::type mask) noexcept {
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(mask));
}
inline int register_bits(RegisterOf<std::int32_t, 4>::type mask) noexcept {
  return _mm_movemask_epi8(reinterpret_cast<__m128i>(mask));
}
inline Double2 register_square_root(Double2 a) noexcept { return _mm_sqrt_pd(a); }
inline Float4 register_square_root(Float4 a) noexcept { return _mm_sqrt_ps(a); }
inline Double2 register_minimum(Double2 a, Double2 b) noexcept { return _mm_min_pd(a, b); }
inline Double2 register_maximum(Double2 a, Double2 b) noexcept { return _mm_max_pd(a, b); }
inline Double2 register_fourth_root(Double2 a) noexcept {
  return _mm_cvtps_pd(_mm_sqrt_ps(_mm_sqrt_ps(_mm_cvtpd_ps(a))));
}
inline Float4 register_fourth_root(Float4 a) noexcept { return _mm_sqrt_ps(_mm_sqrt_ps(a)); }
#if defined(__AVX__)
using Double4 = RegisterOf<double, 4>::type;
using Float8 = RegisterOf<float, 8>::type;
inline Double4 register_square_root(Double4 a) noexcept { return _mm256_sqrt_pd(a); }
inline Float8 register_square_root(Float8 a) noexcept { return _mm256_sqrt_ps(a); }
inline Double4 register_minimum(Double4 a, Double4 b) noexcept { return _mm256_min_pd(a, b); }
inline Double4 register_maximum(Double4 a, Double4 b) noexcept { return _mm256_max_pd(a, b); }
inline Double4 register_fourth_root(Double4 a) noexcept {
  return _mm256_cvtps_pd(_mm_sqrt_ps(_mm_sqrt_ps(_mm256_cvtpd_ps(a))));
}
inline Float8 register_fourth_root(Float8 a) noexcept { return _mm256_sqrt_ps(_mm256_sqrt_ps(a)); }
#endif
#if defined(__AVX2__)
inline int register_bits(RegisterOf<std::int64_t, 4>::type mask) noexcept {
  return _mm256_movemask_epi8(reinterpret_cast<__m256i>(mask));
}
inline int register_bits(RegisterOf<std::int32_t, 8>::type mask) noexcept {
  return _mm256_movemask_epi8(reinterpret_cast<__m256i>(mask));
}
#endif
#endif
}  // namespace detail

/// Lane mask of a Pack: all bits of a lane set (true) or none.
template <class T, int N> struct PackMask : detail::MaskBase<T, N> {
  static constexpr bool single = detail::single_register<T, N>;

  bool operator[](int i) const noexcept {
    if constexpr (single) return this->r[i] != 0;
    else return i < N / 2 ? this->low_half[i] : this->high_half[i - N / 2];
  }
  friend PackMask operator&(const PackMask& a, const PackMask& b) noexcept {
    return detail::map_registers<PackMask>([](auto x, auto y) { return x & y; }, a, b);
  }
  friend PackMask operator|(const PackMask& a, const PackMask& b) noexcept {
    return detail::map_registers<PackMask>([](auto x, auto y) { return x | y; }, a, b);
  }
  friend PackMask operator!(const PackMask& a) noexcept {
    return detail::map_registers<PackMask>([](auto x) { return ~x; }, a);
  }
};

/// N lanes of T, N = 2, 4, 8, ...; arithmetic, comparison and square root are the scalar operations lane by lane, so
/// that a lane computes bit for bit what the scalar program computes.
template <class T, int N> struct Pack : detail::PackBase<T, N> {
  static_assert(std::is_floating_point_v<T> && N >= 2 && (N & (N - 1)) == 0);
  static constexpr bool single = detail::single_register<T, N>;
  using MaskType = PackMask<T, N>;

  Pack() noexcept : Pack(T(0)) {}
  // Written out, so that a struct of packs is copied register by register: the compiler moves a trivially copyable
  // struct as a block of bytes, through memory and the integer registers.
  Pack(const Pack& other) noexcept { *this = other; }
  Pack& operator=(const Pack& other) noexcept {
    if constexpr (single) {
      this->r = other.r;
    } else {
      this->low_half = other.low_half;
      this->high_half = other.high_half;
    }
    return *this;
  }
  Pack(T value) noexcept {  // NOLINT(google-explicit-constructor): a constant stands for all lanes
    if constexpr (single) this->r = value - decltype(this->r){};
    else this->low_half = this->high_half = Pack<T, N / 2>(value);
  }
  template <class U, class = std::enable_if_t<std::is_arithmetic_v<U> && !std::is_same_v<U, T>>>
  Pack(U value) noexcept : Pack(static_cast<T>(value)) {}  // NOLINT(google-explicit-constructor)

  T operator[](int i) const noexcept {
    if constexpr (single) return this->r[i];
    else return i < N / 2 ? this->low_half[i] : this->high_half[i - N / 2];
  }
  void set(int i, T value) noexcept {
    if constexpr (single) this->r[i] = value;
    else if (i < N / 2) this->low_half.set(i, value);
    else this->high_half.set(i - N / 2, value);
  }

  /// Lanes from N consecutive values, aligned or not.
  static Pack load(const T* from) noexcept {
    Pack out;
    if constexpr (single) {
      std::memcpy(&out.r, from, sizeof(out.r));
    } else {
      out.low_half = Pack<T, N / 2>::load(from);
      out.high_half = Pack<T, N / 2>::load(from + N / 2);
    }
    return out;
  }
  void store(T* to) const noexcept {
    if constexpr (single) {
      std::memcpy(to, &this->r, sizeof(this->r));
    } else {
      this->low_half.store(to);
      this->high_half.store(to + N / 2);
    }
  }

  friend Pack operator+(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<Pack>([](auto x, auto y) { return x + y; }, a, b);
  }
  friend Pack operator-(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<Pack>([](auto x, auto y) { return x - y; }, a, b);
  }
  friend Pack operator*(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<Pack>([](auto x, auto y) { return x * y; }, a, b);
  }
  friend Pack operator/(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<Pack>([](auto x, auto y) { return x / y; }, a, b);
  }
  friend Pack operator-(const Pack& a) noexcept {
    return detail::map_registers<Pack>([](auto x) { return -x; }, a);
  }
  Pack& operator+=(const Pack& b) noexcept { return *this = *this + b; }
  Pack& operator-=(const Pack& b) noexcept { return *this = *this - b; }
  Pack& operator*=(const Pack& b) noexcept { return *this = *this * b; }
  Pack& operator/=(const Pack& b) noexcept { return *this = *this / b; }

  friend MaskType operator<(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<MaskType>([](auto x, auto y) { return x < y; }, a, b);
  }
  friend MaskType operator<=(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<MaskType>([](auto x, auto y) { return x <= y; }, a, b);
  }
  friend MaskType operator>(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<MaskType>([](auto x, auto y) { return x > y; }, a, b);
  }
  friend MaskType operator>=(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<MaskType>([](auto x, auto y) { return x >= y; }, a, b);
  }
  friend MaskType operator==(const Pack& a, const Pack& b) noexcept {
    return detail::map_registers<MaskType>([](auto x, auto y) { return x == y; }, a, b);
  }

  /// f lane by lane, for functions that have no vector form.
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
  return detail::map_registers<Pack<T, N>>([](auto m, auto x, auto y) { return m ? x : y; }, mask, a, b);
}
template <class T, int N> bool any(const PackMask<T, N>& mask) noexcept {
  if constexpr (PackMask<T, N>::single) return detail::register_bits(mask.r) != 0;
  else return any(mask.low_half | mask.high_half);
}
template <class T, int N> bool all(const PackMask<T, N>& mask) noexcept { return !any(!mask); }
template <class T, int N> int count(const PackMask<T, N>& mask) noexcept {
  int n = 0;
  for (int i = 0; i < N; ++i) n += mask[i] ? 1 : 0;
  return n;
}
template <class T, int N> Pack<T, N> minimum(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  return detail::map_registers<Pack<T, N>>([](auto x, auto y) { return detail::register_minimum(x, y); }, a, b);
}
template <class T, int N> Pack<T, N> maximum(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  return detail::map_registers<Pack<T, N>>([](auto x, auto y) { return detail::register_maximum(x, y); }, a, b);
}
template <class T, int N> Pack<T, N> absolute(const Pack<T, N>& a) noexcept {
  return detail::map_registers<Pack<T, N>>(
      [](auto x) {
        using R = decltype(x);
        using I = typename detail::RegisterOf<detail::IntegerOf<T>, static_cast<int>(sizeof(R) / sizeof(T))>::type;
        return reinterpret_cast<R>(reinterpret_cast<I>(x) &
                                   std::numeric_limits<detail::IntegerOf<T>>::max());  // sign bit off
      },
      a);
}
template <class T, int N> Pack<T, N> square_root(const Pack<T, N>& a) noexcept {
  return detail::map_registers<Pack<T, N>>([](auto x) { return detail::register_square_root(x); }, a);
}
template <class T, int N> Pack<T, N> fourth_root(const Pack<T, N>& a) noexcept {
  return detail::map_registers<Pack<T, N>>([](auto x) { return detail::register_fourth_root(x); }, a);
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
  if constexpr (N > 2) {
    return largest(maximum(low(a), high(a)));
  } else {
    return static_cast<double>(a[0] > a[1] ? a[0] : a[1]);
  }
}
template <class T, int N> double lane(const Pack<T, N>& a, int i) noexcept { return static_cast<double>(a[i]); }
template <class T, int N> void set_lane(Pack<T, N>& a, int i, double value) noexcept {
  a.set(i, static_cast<T>(value));
}

// --- both sides of an axis ---------------------------------------------------------------------
template <> struct PairOf<double> {
  using type = Pack<double, 2>;
};
template <> struct PairOf<float> {
  using type = Pack<float, 2>;
};
template <class T, int N> struct PairOf<Pack<T, N>> {
  using type = Pack<T, 2 * N>;
};

inline Pack<double, 2> join(double a, double b) noexcept {
  Pack<double, 2> out;
  out.r = decltype(out.r){a, b};
  return out;
}
inline Pack<float, 2> join(float a, float b) noexcept {
  Pack<float, 2> out;
  out.r = decltype(out.r){a, b};
  return out;
}
inline double low(const Pack<double, 2>& a) noexcept { return a[0]; }
inline double high(const Pack<double, 2>& a) noexcept { return a[1]; }
inline float low(const Pack<float, 2>& a) noexcept { return a[0]; }
inline float high(const Pack<float, 2>& a) noexcept { return a[1]; }

template <class T, int N> Pack<T, 2 * N> join(const Pack<T, N>& a, const Pack<T, N>& b) noexcept {
  Pack<T, 2 * N> out;
  if constexpr (!Pack<T, 2 * N>::single) {
    out.low_half = a;
    out.high_half = b;
  } else {
    for (int i = 0; i < N; ++i) {
      out.r[i] = a.r[i];
      out.r[N + i] = b.r[i];
    }
  }
  return out;
}
template <class T, int N> Pack<T, N / 2> low(const Pack<T, N>& a) noexcept {
  if constexpr (!Pack<T, N>::single) {
    return a.low_half;
  } else {
    Pack<T, N / 2> out;
    for (int i = 0; i < N / 2; ++i) out.r[i] = a.r[i];
    return out;
  }
}
template <class T, int N> Pack<T, N / 2> high(const Pack<T, N>& a) noexcept {
  if constexpr (!Pack<T, N>::single) {
    return a.high_half;
  } else {
    Pack<T, N / 2> out;
    for (int i = 0; i < N / 2; ++i) out.r[i] = a.r[N / 2 + i];
    return out;
  }
}

}  // namespace pneuservo
