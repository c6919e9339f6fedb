// The loop's side of `pneuservo guard`.
#include "guard/guard_link.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

namespace pneuservo {

void GuardLink::configure() {
  deactivate();
  page_.reset();
  lock_.reset();
  lock_ = std::make_unique<NameLock>("guard " + guard_name(rig_), "hal.guard.name '" + guard_name(rig_) + "'");
  page_ = std::make_unique<LifeSignPage>(rig_, LifeSignPage::Side::loop);
  // One that was stopped still holds its page.
  const double longest_s = lost_after_timeouts * rig_.hal->guard->timeout_s;
  const std::uint64_t before = page_->sign().guard_beats;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  while (page_->sign().guard_beats == before && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  if (page_->sign().guard_beats == before)
    throw std::runtime_error(fmt::format("hal.guard: the guard '{}' (process {}) does not answer within {:g} s: end it "
                                         "and start it again",
                                         page_->name(), page_->sign().guard_process.load(), longest_s));
  lost_ticks_ = std::llround(longest_s / rig_.period_s) + 1;
}

void GuardLink::activate() {
  LifeSign& sign = page_->sign();
  session_ = sign.session + 1;
  sign.session = session_;
  sign.loop_process = getpid();
  seen_tick_ = -1;
  active_ = true;
  lost_ = tripped_ = false;
}

bool GuardLink::read(std::int64_t tick, Measurement& measurement) noexcept {
  if (!active_) return true;
  const LifeSign& sign = page_->sign();
  const std::uint64_t beats = sign.guard_beats.load(std::memory_order_relaxed);
  if (seen_tick_ < 0 || beats != seen_beats_) seen_tick_ = tick;
  seen_beats_ = beats;
  lost_ = lost_ || tick - seen_tick_ > lost_ticks_;
  tripped_ = tripped_ || sign.tripped.load(std::memory_order_relaxed) == session_;
  if (lost_ || tripped_) measurement.device_faults |= device_guard_lost;
  return true;
}

bool GuardLink::write(std::int64_t, const Command& command) noexcept {
  if (!active_) return true;
  LifeSign& sign = page_->sign();
  sign.loop_beats.fetch_add(1, std::memory_order_relaxed);
  const GuardOrder order = command.ended ? GuardOrder::make_safe : GuardOrder::watch;
  sign.order.store(static_cast<std::uint32_t>(order), std::memory_order_release);
  return true;
}

void GuardLink::deactivate() noexcept {
  if (!active_) return;
  active_ = false;
  page_->sign().order = static_cast<std::uint32_t>(GuardOrder::make_safe);
}

std::vector<std::string> GuardLink::notes() const {
  if (tripped_) return {"guard: it missed the loop's sign of life and wrote the safe output itself"};
  if (lost_) return {"guard: it gave no sign of life any more"};
  return {};
}

}  // namespace pneuservo
