// Residuals of a cylinder that an on/off valve sends from end to end: its position alone.
#pragma once
#include "diagnosis/residuals/command_program.hpp"
#include "diagnosis/residuals/sampled_residuals.hpp"

namespace pneuservo {

/// Both chambers behind their flow control valves, slider, end cushions, simulated from rest at an end stop. What is
/// held out, where no recording is as a whole, is the last quarter of every 0.2 s.
class StrokeResiduals : public SampledResiduals {
 public:
  /// The recordings hold t_s and x_m (0 at mid-stroke), and u_V where it is there. Throws InputError.
  StrokeResiduals(const Rig& rig, const std::vector<Recording>& recordings, int jobs);

 protected:
  std::vector<std::vector<double>> simulated(const Hypothesis& hypothesis, std::size_t recording) const override;

 private:
  std::vector<CommandProgram> programs_;
};

}  // namespace pneuservo
