// EDS and DCF files (CiA 306): what a device's dictionary has, and the values that a DCF wants in it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pneuservo {

/// One entry of a file. Numbers may be "$NODEID+0x180".
struct EdsObject {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string name;
  std::uint16_t data_type = 0;   ///< 0x0003 INTEGER16, 0x0007 UNSIGNED32, ...; 0: not a plain value
  bool can_map = false;
  bool can_read = true, can_write = false;
  std::string standard;    ///< DefaultValue as the file has it
  std::string configured;  ///< ParameterValue of a DCF as the file has it
  int line = 0;

  /// Length of its data type; 0 for texts and domains.
  unsigned bits() const noexcept;
  /// Two's complement.
  bool is_signed() const noexcept;
};

/// Bytes of a text as an object of that type holds them, little-endian; `why` says what is wrong where there are none.
struct EdsBytes {
  std::vector<std::uint8_t> bytes;
  std::string why;
};
/// `node`: number of the node, for $NODEID.
EdsBytes eds_bytes(const EdsObject& object, std::string_view text, std::uint8_t node);

/// A value that a DCF gives and that is not written.
struct LeftOutValue {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string why;
};

/// A read file.
class EdsFile {
 public:
  /// Throws InputError with file and line.
  static EdsFile read(const std::filesystem::path& file);
  static EdsFile parse(const std::string& text, const std::string& source_name);

  const EdsObject* find(std::uint16_t index, std::uint8_t sub) const noexcept;
  /// Entries that a DCF gives a value and that can be written. Communication objects of PDOs are left out, which follow
  /// from the config, as are store and restore (0x1010, 0x1011) and what does not fit its type: see left_out().
  std::vector<EdsObject> configured(std::uint8_t node) const;
  std::vector<LeftOutValue> left_out(std::uint8_t node) const;
  const std::vector<EdsObject>& objects() const noexcept { return objects_; }
  const std::string& source() const noexcept { return source_; }

  /// As the file states them; 0: it does not.
  std::uint32_t vendor = 0, product = 0;
  std::uint32_t node = 0;  ///< of a DCF
  bool describes_modules = false;  ///< objects of modules that may be plugged stand beside the device's own

 private:
  struct Section;
  void take(const Section& section);
  void take_object(const Section& section, EdsObject object);
  void take_compact(const Section& section, const EdsObject& array);
  void take_list(const Section& section);
  std::string why_left_out(const EdsObject& object, std::uint8_t node) const;

  std::string source_;
  std::vector<EdsObject> objects_;  // by index and sub-index
};

}  // namespace pneuservo
