// Bits and counts of process data: an object's place in a PDO, and a channel's value behind its counts.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace pneuservo {

/// Where an object lies in the 8 bytes of a PDO: from bit `offset` (bit 0 of byte 0 first) for `bits` bits, 1 to 64.
struct BitField {
  unsigned offset = 0;
  unsigned bits = 0;
};

constexpr std::uint64_t low_bits(unsigned bits) noexcept {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

/// The bytes as one little-endian number, and back.
constexpr std::uint64_t image_of(const std::array<std::uint8_t, 8>& data) noexcept {
  std::uint64_t image = 0;
  for (unsigned i = 0; i < 8; ++i) image |= static_cast<std::uint64_t>(data[i]) << (8 * i);
  return image;
}
constexpr void put_image(std::array<std::uint8_t, 8>& data, std::uint64_t image) noexcept {
  for (unsigned i = 0; i < 8; ++i) data[i] = static_cast<std::uint8_t>(image >> (8 * i));
}

constexpr std::uint64_t extract(std::uint64_t image, BitField field) noexcept {
  return field.offset >= 64 ? 0 : image >> field.offset & low_bits(field.bits);
}
constexpr std::uint64_t insert(std::uint64_t image, BitField field, std::uint64_t value) noexcept {
  if (field.offset >= 64) return image;
  const std::uint64_t mask = low_bits(field.bits) << field.offset;
  return (image & ~mask) | (value << field.offset & mask);
}

/// Two's complement of `bits` bits.
constexpr std::int64_t sign_extended(std::uint64_t raw, unsigned bits) noexcept {
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return bits >= 64 ? static_cast<std::int64_t>(raw) : static_cast<std::int64_t>((raw ^ sign) - sign);
}

/// value = zero + scale * counts. A negative scale turns the direction round.
struct CountScale {
  double scale = 1.0;  ///< unit of the channel per count, not 0
  double zero = 0.0;   ///< value at 0 counts
  bool is_signed = true;
  unsigned bits = 16;  ///< 1 to 32
  double wrap_counts = 0.0;    ///< the device begins at 0 again after so many, at most 2^32; 0: it never does
  double middle_counts = 0.0;  ///< where it does, the values lie within half of wrap_counts around these

  /// The same of a device that begins at 0 again after `counts`, its values from `lowest` to `highest`.
  CountScale wrapped(double counts, double lowest, double highest) const noexcept {
    CountScale out = *this;
    out.wrap_counts = counts;
    out.middle_counts = (0.5 * (lowest + highest) - zero) / scale;
    return out;
  }
  double counts_of(std::uint64_t raw) const noexcept {
    return is_signed ? static_cast<double>(sign_extended(raw, bits)) : static_cast<double>(raw);
  }
  /// Each reading has one place around the middle.
  double value_of(std::uint64_t raw) const noexcept {
    double counts = counts_of(raw);
    if (wrap_counts > 0.0) counts -= wrap_counts * std::nearbyint((counts - middle_counts) / wrap_counts);
    return zero + scale * counts;
  }
  double lowest_counts() const noexcept { return is_signed ? -std::ldexp(1.0, static_cast<int>(bits) - 1) : 0.0; }
  double highest_counts() const noexcept { return std::ldexp(1.0, static_cast<int>(bits - (is_signed ? 1 : 0))) - 1.0; }
  /// Nearest counts as the device shows them, begun again or held at the ends of their range; not-a-number gives the
  /// counts of the value 0, infinity always an end.
  std::uint64_t raw_of(double value) const noexcept {
    double counts = std::nearbyint(((value == value ? value : 0.0) - zero) / scale);
    if (wrap_counts > 0.0 && std::isfinite(counts)) {
      counts = std::fmod(counts, wrap_counts);
      if (counts < 0.0) counts += wrap_counts;
    } else {
      counts = counts < lowest_counts() ? lowest_counts() : counts > highest_counts() ? highest_counts() : counts;
    }
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(counts)) & low_bits(bits);
  }
};

}  // namespace pneuservo
