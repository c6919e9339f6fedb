// A local socket that stands in for a bus between two processes (unix:PATH): the same frames, no kernel CAN needed.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "can/frame.hpp"

namespace pneuservo {

/// One of two peers. The side that listens (the verb device) serves one other side after the other; it is up while one
/// is there. There is no arbitration and no bus error: what is sent arrives, or its queue is full.
class LocalBus final : public CanCarrier {
 public:
  enum class Side { listens, connects };
  /// Throws std::runtime_error: path too long, nobody listens, somebody listens already, or something else than a
  /// socket stands there.
  LocalBus(const std::string& path, Side side);
  ~LocalBus() override;
  LocalBus(const LocalBus&) = delete;
  LocalBus& operator=(const LocalBus&) = delete;

  void accept_only(const std::vector<std::uint32_t>& ids) override { ids_ = ids; }
  void wait(std::int64_t timeout_ns) override;
  Sent send(const CanFrame& frame) noexcept override;
  bool receive(ReceivedFrame& received) noexcept override;
  std::int64_t now_ns() noexcept override;
  bool is_up() const noexcept override { return peer_ >= 0; }
  std::uint64_t dropped() const noexcept override { return 0; }
  std::string name() const override { return "unix:" + path_; }

 private:
  void listen_on_path();
  void remove_old_socket() const;
  void hang_up() noexcept;
  bool accepts(const CanFrame& frame) const noexcept;

  std::string path_;
  int listener_ = -1, peer_ = -1;
  std::uint64_t inode_ = 0;  // of the socket that was made
  std::vector<std::uint32_t> ids_;  // empty: everything
};

}  // namespace pneuservo
