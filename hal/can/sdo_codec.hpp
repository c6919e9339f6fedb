// Service data objects (CiA 301): the frames of expedited and segmented transfers, and abort codes in words.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "can/canopen.hpp"

namespace pneuservo {

/// Abort codes that are sent or asked for here.
enum class SdoAbort : std::uint32_t {
  none = 0,
  toggle = 0x05030000,
  timeout = 0x05040000,
  command = 0x05040001,
  access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_object = 0x06020000,
  not_mappable = 0x06040041,
  mapping_length = 0x06040042,
  length = 0x06070010,
  no_sub_index = 0x06090011,
  value = 0x06090030,
  too_low = 0x06090032,
  general = 0x08000000,
  state = 0x08000022,
};
/// The code in words, "no such object", as CiA 301 has them; others with their number.
std::string sdo_abort_text(std::uint32_t code);

/// One side's message, decoded: what the first byte says, without meaning given to it yet.
struct SdoMessage {
  std::uint8_t specifier = 0;  ///< upper three bits of the first byte
  bool toggle = false, expedited = false, sized = false, last = false;
  std::uint8_t unused = 0;     ///< bytes of the data field that hold none
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t first = 0;      ///< the first byte itself
};

/// Command specifiers of the client, and of the server.
inline constexpr std::uint8_t sdo_download_segment = 0, sdo_download = 1, sdo_upload = 2, sdo_upload_segment = 3,
                              sdo_abort_specifier = 4;
inline constexpr std::uint8_t sdo_segment_uploaded = 0, sdo_segment_downloaded = 1, sdo_upload_begun = 2,
                              sdo_downloaded = 3;

/// Decodes what the first four bytes say, absent ones as 0; empty for a frame without any.
std::optional<SdoMessage> parse_sdo(const CanFrame& frame) noexcept;
/// The same of a server's answer; empty unless it has all the bytes that it speaks of. Some devices send no more.
std::optional<SdoMessage> parse_sdo_answer(const CanFrame& frame) noexcept;

/// A message with index and sub-index and up to 4 bytes of data behind them.
CanFrame sdo_frame(std::uint32_t id, std::uint8_t first, std::uint16_t index, std::uint8_t sub,
                   std::uint32_t data) noexcept;
CanFrame sdo_abort_frame(std::uint32_t id, std::uint16_t index, std::uint8_t sub, SdoAbort code) noexcept;
/// Up to 7 bytes from `from` on. `specifier` is that of the sender.
CanFrame sdo_segment_frame(std::uint32_t id, std::uint8_t specifier, bool toggle, const std::uint8_t* from,
                           std::size_t count, bool last) noexcept;

}  // namespace pneuservo
