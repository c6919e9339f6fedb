// Service data objects: frames of transfers, abort codes in words.
#include "can/sdo_codec.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pneuservo {

std::string sdo_abort_text(std::uint32_t code) {
  switch (static_cast<SdoAbort>(code)) {
    case SdoAbort::none: break;
    case SdoAbort::toggle: return "toggle bit not alternated";
    case SdoAbort::timeout: return "SDO protocol timed out";
    case SdoAbort::command: return "command specifier not valid or unknown";
    case SdoAbort::access: return "unsupported access to an object";
    case SdoAbort::write_only: return "the object can only be written";
    case SdoAbort::read_only: return "the object can only be read";
    case SdoAbort::no_object: return "no such object";
    case SdoAbort::not_mappable: return "the object cannot be mapped to the PDO";
    case SdoAbort::mapping_length: return "the mapped objects exceed the PDO length";
    case SdoAbort::length: return "data type or length does not match";
    case SdoAbort::no_sub_index: return "no such sub-index";
    case SdoAbort::value: return "value out of range";
    case SdoAbort::general: return "general error";
    case SdoAbort::state: return "refused in the present state of the device";
  }
  return fmt::format("abort code 0x{:08x}", code);
}

std::optional<SdoMessage> parse_sdo(const CanFrame& frame) noexcept {
  if (!is_plain(frame) || frame.length != 8) return {};
  SdoMessage m;
  m.first = frame.data[0];
  m.specifier = m.first >> 5;
  m.toggle = (m.first & 0x10) != 0;
  m.expedited = (m.first & 0x02) != 0;
  m.sized = (m.first & 0x01) != 0;
  m.last = (m.first & 0x01) != 0;
  m.unused = m.first >> 2 & 0x03;
  m.index = get_u16(&frame.data[1]);
  m.sub = frame.data[3];
  return m;
}

CanFrame sdo_frame(std::uint32_t id, std::uint8_t first, std::uint16_t index, std::uint8_t sub,
                   std::uint32_t data) noexcept {
  CanFrame frame{.id = id, .length = 8};
  frame.data[0] = first;
  put_u16(&frame.data[1], index);
  frame.data[3] = sub;
  put_u32(&frame.data[4], data);
  return frame;
}

CanFrame sdo_abort_frame(std::uint32_t id, std::uint16_t index, std::uint8_t sub, SdoAbort code) noexcept {
  return sdo_frame(id, 0x80, index, sub, static_cast<std::uint32_t>(code));
}

CanFrame sdo_segment_frame(std::uint32_t id, std::uint8_t specifier, bool toggle, const std::uint8_t* from,
                           std::size_t count, bool last) noexcept {
  CanFrame frame{.id = id, .length = 8};
  count = std::min<std::size_t>(count, 7);
  frame.data[0] =
      static_cast<std::uint8_t>(specifier << 5 | (toggle ? 0x10 : 0) | (7 - count) << 1 | (last ? 0x01 : 0));
  std::copy_n(from, count, frame.data.begin() + 1);
  return frame;
}

}  // namespace pneuservo
