// The server's side of service data objects: a device's dictionary read and written, expedited and in segments.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "can/object_dictionary.hpp"
#include "can/sdo_codec.hpp"

namespace pneuservo {

/// One transfer at a time, as the predefined connection set has it. Any frame may be given to it.
class SdoServer {
 public:
  /// Called with a value before it is stored; an abort code refuses it.
  using AcceptWrite = std::function<SdoAbort(std::uint16_t index, std::uint8_t sub, std::uint32_t value)>;

  SdoServer(std::uint8_t node, ObjectDictionary& dictionary, AcceptWrite accept_write)
      : answer_id_(cob_sdo_answer + node), dictionary_(dictionary), accept_write_(std::move(accept_write)) {}

  /// The answer to a request; empty where none is due (an abort, a frame that is none).
  std::optional<CanFrame> answer(const CanFrame& request);
  void reset() noexcept { transfer_ = Transfer::none; }

 private:
  enum class Transfer { none, download, upload };
  static constexpr std::size_t largest = 64;

  CanFrame refuse(SdoAbort code);
  CanFrame begin_download(const SdoMessage& message, const CanFrame& request);
  CanFrame continue_download(const SdoMessage& message, const CanFrame& request);
  CanFrame begin_upload();
  CanFrame continue_upload(const SdoMessage& message);
  SdoAbort check(bool writes) const;
  SdoAbort store(const std::uint8_t* bytes, std::size_t count);

  std::uint32_t answer_id_;
  ObjectDictionary& dictionary_;
  AcceptWrite accept_write_;
  Transfer transfer_ = Transfer::none;
  std::uint16_t index_ = 0;
  std::uint8_t sub_ = 0;
  bool toggle_ = false;
  std::array<std::uint8_t, largest> buffer_{};
  std::size_t size_ = 0, done_ = 0;
};

}  // namespace pneuservo
