// Service data objects: frames of transfers, abort codes in words.
#include "can/sdo_codec.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace pneuservo {

namespace {

struct AbortWords {
  std::uint32_t code;
  const char* words;
};
constexpr std::array abort_words{
    AbortWords{0x05030000, "toggle bit not alternated"},
    AbortWords{0x05040000, "SDO protocol timed out"},
    AbortWords{0x05040001, "command specifier not valid or unknown"},
    AbortWords{0x05040002, "invalid block size"},
    AbortWords{0x05040003, "invalid sequence number"},
    AbortWords{0x05040004, "checksum error"},
    AbortWords{0x05040005, "the device is out of memory"},
    AbortWords{0x06010000, "unsupported access to an object"},
    AbortWords{0x06010001, "the object can only be written"},
    AbortWords{0x06010002, "the object can only be read"},
    AbortWords{0x06020000, "no such object"},
    AbortWords{0x06040041, "the object cannot be mapped to the PDO"},
    AbortWords{0x06040042, "the mapped objects exceed the PDO length"},
    AbortWords{0x06040043, "parameters do not fit each other"},
    AbortWords{0x06040047, "the device is in conflict with itself"},
    AbortWords{0x06060000, "a hardware error of the device"},
    AbortWords{0x06070010, "data type or length does not match"},
    AbortWords{0x06070012, "data too long for the object"},
    AbortWords{0x06070013, "data too short for the object"},
    AbortWords{0x06090011, "no such sub-index"},
    AbortWords{0x06090030, "value out of range"},
    AbortWords{0x06090031, "value too high"},
    AbortWords{0x06090032, "value too low"},
    AbortWords{0x06090036, "largest value below the smallest"},
    AbortWords{0x060A0023, "a resource of the device is not there"},
    AbortWords{0x08000000, "general error"},
    AbortWords{0x08000020, "data cannot be transferred or stored"},
    AbortWords{0x08000021, "data cannot be transferred or stored: the device is under local control"},
    AbortWords{0x08000022, "refused in the present state of the device"},
    AbortWords{0x08000023, "the device has no object dictionary now"},
    AbortWords{0x08000024, "the device has no data for it"},
};

}  // namespace

std::string sdo_abort_text(std::uint32_t code) {
  const auto found = std::ranges::find(abort_words, code, &AbortWords::code);
  return found == abort_words.end() ? fmt::format("abort code 0x{:08x} of the device's own", code)
                                    : fmt::format("{} (0x{:08x})", found->words, code);
}

std::optional<SdoMessage> parse_sdo(const CanFrame& frame) noexcept {
  if (!is_plain(frame) || frame.length < 1) return {};
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

std::optional<SdoMessage> parse_sdo_answer(const CanFrame& frame) noexcept {
  const auto m = parse_sdo(frame);
  if (!m) return {};
  unsigned needed = 4;
  if (m->specifier == sdo_segment_uploaded) needed = 8u - (m->first >> 1 & 0x07);
  else if (m->specifier == sdo_segment_downloaded) needed = 1;
  else if (m->specifier == sdo_abort_specifier) needed = 8;
  else if (m->specifier == sdo_upload_begun && m->expedited) needed = m->sized ? 8u - m->unused : 5u;
  return frame.length >= needed ? m : std::nullopt;
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
