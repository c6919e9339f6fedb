// Backend `replay`: the measurements of a recording as if they came from hardware; commands are compared, not sent.
#pragma once
#include <array>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include <pneuservo/hal/backend.hpp>

#include "record/reader.hpp"

namespace pneuservo {

/// Row i stands for the tick round(t_s / period). A row without a value gives an invalid channel, a recording without a
/// column an absent one. read() ends where the rows end.
class ReplayBackend final : public Backend {
 public:
  /// The recording must have the signals `needed`; throws InputError naming a missing column.
  ReplayBackend(Recording recording, double period_s,
                std::initializer_list<Signal> needed = {Signal::x, Signal::p1_port, Signal::p2_port});
  void configure() override {}
  void activate() override { next_ = 0; }
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  /// False where the column `fault` says that the recorded run could not write.
  bool write(std::int64_t, const Command&) noexcept override;
  void deactivate() noexcept override {}
  Truth truth() const noexcept override;
  Origins origins() const override;
  std::string name() const override { return "replay"; }

  const Recording& recording() const noexcept { return recording_; }
  std::size_t rows() const noexcept { return ticks_.size(); }
  /// Tick of row i.
  std::int64_t tick(std::size_t i) const noexcept { return ticks_[i]; }

 private:
  using Column = const std::vector<double>*;
  std::uint64_t recorded_faults() const noexcept;
  std::uint64_t recorded_switches() const noexcept;

  Recording recording_;
  std::vector<std::int64_t> ticks_;
  PerSignal<Column> measured_;  // null: absent, as below
  std::array<Column, 3> truth_{};  // position, chambers
  Column fault_ = nullptr, switches_ = nullptr;
  std::size_t next_ = 0, row_ = 0;
};

}  // namespace pneuservo
