// The loop's side of `pneuservo guard`: gives its sign of life, and looks for the guard's.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

#include "device_lock.hpp"
#include "guard/life_sign.hpp"

namespace pneuservo {

/// A source without channels, behind all that have outputs: its sign of life says that they were written. With a fault
/// or the end it asks the guard for the safe output, too.
class GuardLink final : public Backend {
 public:
  /// The guard looks four times within its time; after four such times without a sign it is lost.
  static constexpr double looks_a_timeout = 4.0, lost_after_timeouts = 4.0;

  explicit GuardLink(const Rig& rig) : rig_(rig) {}
  ~GuardLink() override { deactivate(); }

  /// Throws std::runtime_error where no guard answers.
  void configure() override;
  void activate() override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override;
  Origins origins() const override { return {}; }
  std::vector<std::string> notes() const override;
  std::string name() const override { return "guard"; }

 private:
  Rig rig_;
  std::unique_ptr<NameLock> lock_;
  std::unique_ptr<LifeSignPage> page_;
  std::uint64_t seen_beats_ = 0;
  std::int64_t seen_tick_ = -1, lost_ticks_ = 0;
  std::uint32_t session_ = 0;
  bool active_ = false, lost_ = false, tripped_ = false;
};

}  // namespace pneuservo
