// The client's side of service data objects.
#include "can/sdo_client.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pneuservo {
namespace {

constexpr std::size_t longest_object = 4096;

/// Little-endian, as all of CANopen has it.
std::uint32_t number_in(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

}  // namespace

void SdoClient::fail(std::uint16_t index, std::uint8_t sub, const std::string& what, std::uint32_t code) {
  throw SdoError(fmt::format("{}: node {} ({}), object 0x{:04x}:{}: {}", bus_.name(), name_, node_, index, sub, what),
                 code);
}

std::optional<CanFrame> SdoClient::wait_for_answer(std::uint16_t index, std::uint8_t sub) {
  const std::int64_t end_ns = bus_.now_ns() + std::llround(timeout_s_ * 1e9);
  for (std::int64_t now_ns = bus_.now_ns(); now_ns < end_ns; now_ns = bus_.now_ns()) {
    ReceivedFrame received;
    while (bus_.receive(received)) {
      const auto message = parse_sdo_answer(received.frame);
      if (!message || received.frame.id != cob_sdo_answer + node_) {
        if (others_) others_(received);
        continue;
      }
      const bool has_object = message->specifier == sdo_downloaded || message->specifier == sdo_upload_begun;
      // The answer to a request that was given up: not ours.
      if (has_object && (message->index != index || message->sub != sub)) continue;
      return received.frame;
    }
    if (!bus_.is_up()) fail(index, sub, "the link is down", 0);
    bus_.wait(end_ns - now_ns);
  }
  return {};
}

CanFrame SdoClient::ask(const CanFrame& request, std::uint16_t index, std::uint8_t sub, int tries) {
  std::optional<CanFrame> answer;
  for (int i = 0; i < tries && !answer; ++i) {
    if (bus_.send(request) != Sent::sent) fail(index, sub, "the request could not be sent", 0);
    answer = wait_for_answer(index, sub);
    if (!answer) bus_.send(sdo_abort_frame(request_id(), index, sub, SdoAbort::timeout));
  }
  if (!answer)
    fail(index, sub,
         fmt::format("no answer within {:g} s, asked {} times: is the node there, its number and the bit rate right? "
                     "A slow device: hal.can.nodes.{}.sdo_timeout_s",
                     timeout_s_, tries, name_),
         0);
  if (answer->data[0] >> 5 == sdo_abort_specifier) {
    const std::uint32_t code = get_u32(&answer->data[4]);
    fail(index, sub, "refused: " + sdo_abort_text(code), code);
  }
  return *answer;
}

std::vector<std::uint8_t> SdoClient::read(std::uint16_t index, std::uint8_t sub) {
  const CanFrame begun = ask(sdo_frame(request_id(), sdo_upload << 5, index, sub, 0), index, sub);
  const SdoMessage first = *parse_sdo_answer(begun);
  if (first.specifier != sdo_upload_begun) fail(index, sub, "an answer of the wrong kind", 0);
  if (first.expedited) {
    const std::size_t count = first.sized ? 4u - first.unused : begun.length - 4u;
    return {begun.data.begin() + 4, begun.data.begin() + 4 + static_cast<std::ptrdiff_t>(count)};
  }
  std::vector<std::uint8_t> bytes;
  for (bool toggle = false;; toggle = !toggle) {
    const auto request = static_cast<std::uint8_t>(sdo_upload_segment << 5 | (toggle ? 0x10 : 0));
    const CanFrame segment = ask(sdo_frame(request_id(), request, 0, 0, 0), index, sub, 1);
    const SdoMessage message = *parse_sdo_answer(segment);
    if (message.specifier != sdo_segment_uploaded || message.toggle != toggle)
      fail(index, sub, "a segment out of order", 0);
    const auto count = static_cast<std::ptrdiff_t>(7 - (message.first >> 1 & 0x07));
    bytes.insert(bytes.end(), segment.data.begin() + 1, segment.data.begin() + 1 + count);
    if (message.last) return bytes;
    if (bytes.size() > longest_object) fail(index, sub, "an object without end", 0);
  }
}

std::uint32_t SdoClient::read_number(std::uint16_t index, std::uint8_t sub) {
  const std::vector<std::uint8_t> bytes = read(index, sub);
  if (bytes.empty() || bytes.size() > 4) fail(index, sub, fmt::format("{} bytes, expected a number", bytes.size()), 0);
  return number_in(bytes);
}

std::optional<std::uint32_t> SdoClient::find_number(std::uint16_t index, std::uint8_t sub) {
  try {
    return read_number(index, sub);
  } catch (const SdoError& error) {
    const auto code = static_cast<SdoAbort>(error.code);
    if (code == SdoAbort::no_object || code == SdoAbort::no_sub_index) return {};
    throw;
  }
}

void SdoClient::write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes) {
  const auto first = static_cast<std::uint8_t>(sdo_download << 5 | (4 - bytes) << 2 | 0x03);
  const CanFrame answer = ask(sdo_frame(request_id(), first, index, sub, value), index, sub);
  if (answer.data[0] >> 5 != sdo_downloaded) fail(index, sub, "an answer of the wrong kind", 0);
}

void SdoClient::write_bytes(std::uint16_t index, std::uint8_t sub, const std::vector<std::uint8_t>& bytes) {
  const auto first = static_cast<std::uint8_t>(sdo_download << 5 | 0x01);
  ask(sdo_frame(request_id(), first, index, sub, static_cast<std::uint32_t>(bytes.size())), index, sub);
  bool toggle = false;
  for (std::size_t done = 0; done < bytes.size(); toggle = !toggle) {
    const std::size_t count = std::min<std::size_t>(bytes.size() - done, 7);
    const bool last = done + count == bytes.size();
    const CanFrame answer = ask(
        sdo_segment_frame(request_id(), sdo_download_segment, toggle, bytes.data() + done, count, last), index, sub, 1);
    if (answer.data[0] >> 5 != sdo_segment_downloaded) fail(index, sub, "a segment out of order", 0);
    done += count;
  }
}

void SdoClient::write_checked(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  const std::vector<std::uint8_t> held = read(index, sub);
  const std::size_t bytes = held.size();
  if (bytes < 1 || bytes > 4) fail(index, sub, fmt::format("{} bytes, expected a number", bytes), 0);
  const std::uint32_t mask = bytes == 4 ? ~0u : (1u << (8 * bytes)) - 1u;
  if (number_in(held) == (value & mask)) return;
  try {
    write(index, sub, value, static_cast<unsigned>(bytes));
  } catch (const SdoError& error) {
    if (error.code == 0) throw;
    throw SdoError(fmt::format("{}: found 0x{:x}, expected 0x{:x}; its manual says what it takes, and in which state",
                               error.what(), number_in(held), value & mask),
                   error.code);
  }
  const std::uint32_t stored = read_number(index, sub);
  if (stored != (value & mask))
    fail(index, sub, fmt::format("found 0x{:x} after 0x{:x} was written", stored, value & mask), 0);
}

void SdoClient::write_any(std::uint16_t index, std::uint8_t sub, const std::vector<std::uint8_t>& bytes) {
  if (bytes.empty() || bytes.size() > 4) write_bytes(index, sub, bytes);
  else write(index, sub, number_in(bytes), static_cast<unsigned>(bytes.size()));
}

bool SdoClient::write_found(std::uint16_t index, std::uint8_t sub, std::uint32_t value) {
  if (!find_number(index, sub)) return false;
  write_checked(index, sub, value);
  return true;
}

}  // namespace pneuservo
