// A local socket that stands in for a bus between two processes (unix:PATH): the same frames, no kernel CAN needed.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "can/frame.hpp"
#include "can/socket_frames.hpp"

namespace pneuservo {

/// The side that listens (the verb device) serves up to four others and passes on what each sends, as a bus would; it
/// is up while one is there. There is no arbitration and no bus error: what is sent arrives, or its queue is full.
class LocalBus final : public CanCarrier {
 public:
  enum class Side { listens, connects };
  /// Throws std::runtime_error: path too long, nobody listens, somebody listens already, or something else than a
  /// socket stands there.
  LocalBus(const std::string& path, Side side);
  ~LocalBus() override;
  LocalBus(const LocalBus&) = delete;
  LocalBus& operator=(const LocalBus&) = delete;

  void accept_only(const std::vector<std::uint32_t>&) override {}  // no filter: who receives counts what is foreign
  void wait(std::int64_t timeout_ns) override;
  Sent send(const CanFrame& frame) noexcept override;
  bool receive(ReceivedFrame& received) noexcept override;
  std::int64_t now_ns() noexcept override;
  bool is_up() const noexcept override { return peers_ > 0; }
  std::uint64_t dropped() const noexcept override { return 0; }
  std::string name() const override { return "unix:" + path_; }

 private:
  static constexpr std::size_t most_peers = 4;
  struct Peer {
    int socket = -1;
    MessageBatch messages{};
  };

  void listen_on_path();
  void remove_old_socket() const;
  void add_peer(int socket);
  void hang_up(std::size_t peer) noexcept;
  Sent send_but(std::size_t left_out, const CanFrame& frame) noexcept;

  std::string path_;
  int listener_ = -1;
  std::array<Peer, most_peers> peer_{};
  std::size_t peers_ = 0;
  std::uint64_t inode_ = 0;  // of the socket that was made
};

}  // namespace pneuservo
