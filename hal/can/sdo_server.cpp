// The server's side of service data objects.
#include "can/sdo_server.hpp"

#include <algorithm>

namespace pneuservo {

std::optional<CanFrame> SdoServer::answer(const CanFrame& request) {
  const auto message = parse_sdo(request);
  if (!message || request.length != 8) return {};
  switch (message->specifier) {
    case sdo_abort_specifier: transfer_ = Transfer::none; return {};
    case sdo_download_segment:
      return transfer_ == Transfer::download ? continue_download(*message, request) : refuse(SdoAbort::command);
    case sdo_upload_segment:
      return transfer_ == Transfer::upload ? continue_upload(*message) : refuse(SdoAbort::command);
    default: break;
  }
  index_ = message->index;
  sub_ = message->sub;
  transfer_ = Transfer::none;
  if (message->specifier != sdo_download && message->specifier != sdo_upload) return refuse(SdoAbort::command);
  const SdoAbort wrong = check(message->specifier == sdo_download);
  if (wrong != SdoAbort::none) return refuse(wrong);
  return message->specifier == sdo_download ? begin_download(*message, request) : begin_upload();
}

CanFrame SdoServer::refuse(SdoAbort code) {
  transfer_ = Transfer::none;
  return sdo_abort_frame(answer_id_, index_, sub_, code);
}

SdoAbort SdoServer::check(bool writes) const {
  const DictionaryEntry* entry = dictionary_.find(index_, sub_);
  if (entry == nullptr) return dictionary_.has_index(index_) ? SdoAbort::no_sub_index : SdoAbort::no_object;
  if (writes && !entry->can_write) return SdoAbort::read_only;
  if (!writes && !entry->can_read) return SdoAbort::write_only;
  return SdoAbort::none;
}

SdoAbort SdoServer::store(const std::uint8_t* bytes, std::size_t count) {
  DictionaryEntry* entry = dictionary_.find(index_, sub_);
  if (entry == nullptr || entry->is_text || count != entry->bytes()) return SdoAbort::length;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  const SdoAbort refused = accept_write_ ? accept_write_(index_, sub_, value) : SdoAbort::none;
  if (refused != SdoAbort::none) return refused;
  entry->value = value;
  ++entry->writes;
  return refused;
}

CanFrame SdoServer::begin_download(const SdoMessage& message, const CanFrame& request) {
  if (message.expedited) {
    const std::size_t stored = dictionary_.find(index_, sub_)->bytes();
    const std::size_t count = message.sized ? 4u - message.unused : std::min<std::size_t>(stored, 4);
    const SdoAbort refused = store(&request.data[4], count);
    if (refused != SdoAbort::none) return refuse(refused);
  } else {
    if (message.sized && get_u32(&request.data[4]) > largest) return refuse(SdoAbort::length);
    transfer_ = Transfer::download;
    toggle_ = false;
    size_ = 0;
  }
  return sdo_frame(answer_id_, sdo_downloaded << 5, index_, sub_, 0);
}

CanFrame SdoServer::continue_download(const SdoMessage& message, const CanFrame& request) {
  if (message.toggle != toggle_) return refuse(SdoAbort::toggle);
  const std::size_t count = 7u - (message.first >> 1 & 0x07);
  if (size_ + count > largest) return refuse(SdoAbort::length);
  std::copy_n(request.data.begin() + 1, count, buffer_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += count;
  if (message.last) {
    const SdoAbort refused = store(buffer_.data(), size_);
    if (refused != SdoAbort::none) return refuse(refused);
    transfer_ = Transfer::none;
  }
  CanFrame frame{.id = answer_id_, .length = 8};
  frame.data[0] = static_cast<std::uint8_t>(sdo_segment_downloaded << 5 | (toggle_ ? 0x10 : 0));
  toggle_ = !toggle_;
  return frame;
}

CanFrame SdoServer::begin_upload() {
  const DictionaryEntry& entry = *dictionary_.find(index_, sub_);
  const std::size_t count = std::min(entry.bytes(), largest);
  if (!entry.is_text) {
    const auto first = static_cast<std::uint8_t>(sdo_upload_begun << 5 | (4 - count) << 2 | 0x03);
    return sdo_frame(answer_id_, first, index_, sub_, entry.value);
  }
  std::copy_n(entry.text.begin(), count, buffer_.begin());
  transfer_ = Transfer::upload;
  toggle_ = false;
  size_ = count;
  done_ = 0;
  return sdo_frame(answer_id_, static_cast<std::uint8_t>(sdo_upload_begun << 5 | 0x01), index_, sub_,
                   static_cast<std::uint32_t>(size_));
}

CanFrame SdoServer::continue_upload(const SdoMessage& message) {
  if (message.toggle != toggle_) return refuse(SdoAbort::toggle);
  const std::size_t count = std::min<std::size_t>(size_ - done_, 7);
  const bool last = done_ + count == size_;
  const CanFrame frame =
      sdo_segment_frame(answer_id_, sdo_segment_uploaded, toggle_, buffer_.data() + done_, count, last);
  done_ += count;
  toggle_ = !toggle_;
  if (last) transfer_ = Transfer::none;
  return frame;
}

}  // namespace pneuservo
