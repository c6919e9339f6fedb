// EDS and DCF files (CiA 306): what a device's dictionary has, and the values that a DCF wants in it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pneuservo {

/// One entry of a file. Numbers may be "$NODEID+0x180".
struct EdsObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string name;
  std::uint16_t data_type = 0;   ///< 0x0003 INTEGER16, 0x0007 UNSIGNED32, ...; 0: not a plain value
  bool can_map = false;
  bool can_write = false;
  std::optional<std::uint32_t> standard;    ///< DefaultValue
  std::optional<std::uint32_t> configured;  ///< ParameterValue of a DCF
  bool adds_node = false;                   ///< the node's number is added to the value
  int line = 0;

  /// ParameterValue, else DefaultValue, else 0; with the node's number where the file says so.
  std::uint32_t value(std::uint8_t node) const noexcept {
    return configured.value_or(standard.value_or(0)) + (adds_node ? node : 0u);
  }
  /// Length of its data type; 0 for texts and domains.
  unsigned bits() const noexcept;
  /// Two's complement.
  bool is_signed() const noexcept;
};

/// A read file.
class EdsFile {
 public:
  /// Throws InputError with file and line.
  static EdsFile read(const std::filesystem::path& file);
  static EdsFile parse(const std::string& text, const std::string& source_name);

  const EdsObject* find(std::uint16_t index, std::uint8_t sub) const noexcept;
  /// Entries that a DCF gives a value and that can be written, communication objects of PDOs left out: those follow
  /// from the config.
  std::vector<EdsObject> configured() const;
  const std::vector<EdsObject>& objects() const noexcept { return objects_; }
  const std::string& source() const noexcept { return source_; }

 private:
  std::string source_;
  std::vector<EdsObject> objects_;  // by index and sub-index
};

}  // namespace pneuservo
