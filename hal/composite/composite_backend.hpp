// Backend `configured`: each channel from the source that the config's section `hal` names for it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/hal/backend.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// The one place that routes channels. Commands go to every source: the valve's own by its channel `u`, and the
/// simulated plant, which follows what the real valve is told. A source that no channel names is not made.
class CompositeBackend final : public Backend {
 public:
  /// Throws InputError where the rig has no section `hal`.
  explicit CompositeBackend(const Rig& rig);

  void configure() override;
  void activate() override;
  bool is_paced() const noexcept override;
  Pace await_sample() noexcept override;
  bool read(std::int64_t tick, Measurement& measurement) noexcept override;
  bool write(std::int64_t tick, const Command& command) noexcept override;
  void deactivate() noexcept override;
  bool emergency_write() noexcept override;
  Origins origins() const override;
  SafeOutput safe_output() const override;
  std::vector<std::string> notes() const override;
  std::string name() const override { return "configured"; }

 private:
  using Gives = PerSignal<bool>;  ///< channels that are taken from a source
  struct Source {
    std::unique_ptr<Backend> backend;
    Gives gives{};
  };

  std::vector<Source> sources_;
  Origins origins_;
  PerSignal<double> zeros_;  ///< added to what the sources give
};

}  // namespace pneuservo
