// The client's side of service data objects: reads and writes a device's dictionary while nothing runs in real time.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "can/frame.hpp"
#include "can/sdo_codec.hpp"

namespace pneuservo {

/// A device refused, or did not answer. `code` is its abort code; 0: no answer.
struct SdoError : std::runtime_error {
  SdoError(const std::string& message, std::uint32_t abort_code) : std::runtime_error(message), code(abort_code) {}
  std::uint32_t code;
};

/// Blocks for at most three times the timeout a message: a request without answer is sent again, as a lost frame or a
/// device that is busy after its start wants it. Frames that are no answers go to `others` (heartbeats, emergencies).
class SdoClient {
 public:
  using Others = std::function<void(const ReceivedFrame&)>;
  static constexpr int attempts = 3;
  static constexpr double usual_timeout_s = 1.0;  ///< a device that writes to flash takes some 0.7 s
  SdoClient(CanCarrier& bus, std::uint8_t node, std::string name, Others others, double timeout_s = usual_timeout_s)
      : bus_(bus), node_(node), name_(std::move(name)), others_(std::move(others)), timeout_s_(timeout_s) {}

  /// Bytes of the object, expedited or in segments. Throws SdoError.
  std::vector<std::uint8_t> read(std::uint16_t index, std::uint8_t sub);
  /// A number of up to 4 bytes. Throws SdoError.
  std::uint32_t read_number(std::uint16_t index, std::uint8_t sub);
  /// Empty where the device has no such object; other refusals throw.
  std::optional<std::uint32_t> find_number(std::uint16_t index, std::uint8_t sub);

  /// Writes `bytes` bytes, 1 to 4. Throws SdoError.
  void write(std::uint16_t index, std::uint8_t sub, std::uint32_t value, unsigned bytes);
  /// Writes them as they are, in segments where there are more than 4. Throws SdoError.
  void write_any(std::uint16_t index, std::uint8_t sub, const std::vector<std::uint8_t>& bytes);
  /// Writes more than 4 bytes in segments. Throws SdoError.
  void write_bytes(std::uint16_t index, std::uint8_t sub, const std::vector<std::uint8_t>& bytes);
  /// Writes as many bytes as the object has (they differ from maker to maker), reads it back and compares. What holds
  /// the value already is left alone: some devices let it only be read.
  void write_checked(std::uint16_t index, std::uint8_t sub, std::uint32_t value);
  /// The same where the device has the object; false: it has none.
  bool write_found(std::uint16_t index, std::uint8_t sub, std::uint32_t value);

  const std::string& name() const noexcept { return name_; }
  std::uint8_t node() const noexcept { return node_; }

 private:
  /// `tries`: 1 for a segment, which may not come twice.
  CanFrame ask(const CanFrame& request, std::uint16_t index, std::uint8_t sub, int tries = attempts);
  std::optional<CanFrame> wait_for_answer(std::uint16_t index, std::uint8_t sub);
  [[noreturn]] void fail(std::uint16_t index, std::uint8_t sub, const std::string& what, std::uint32_t code);
  std::uint32_t request_id() const noexcept { return cob_sdo_request + node_; }

  CanCarrier& bus_;
  std::uint8_t node_;
  std::string name_;
  Others others_;
  double timeout_s_;
};

}  // namespace pneuservo
