// Residuals of a vessel behind an on/off valve: pressures in it and at the valve's port.
#pragma once
#include <array>

#include "diagnosis/residuals/command_program.hpp"
#include "diagnosis/residuals/sampled_residuals.hpp"

namespace pneuservo {

/// Orifices of the valve, the line where there is one, the vessel with its wall and leaks, simulated from the measured
/// pressure at the start. The last third of each recording is held out where no recording is as a whole: a model that
/// only fits does not go on.
class VesselResiduals : public SampledResiduals {
 public:
  /// The recordings hold t_s and p1_chamber_Pa, absolute; p1_port_Pa (with a line), p_supply_Pa and u_V where they are
  /// there. Throws InputError.
  VesselResiduals(const Rig& rig, const std::vector<Recording>& recordings, int jobs);
  std::size_t start_factor_count() const override { return 2 * recordings().size(); }
  double start_factor_sigma() const override;

 protected:
  std::vector<std::vector<double>> simulated(const Hypothesis& hypothesis, std::size_t recording) const override;

 private:
  struct Inputs {
    double begin_s = 0;  ///< of the simulation
    double start_Pa = 0, supply_Pa = 0;  ///< supply 0: as the config has it
    bool fills = false;  ///< begins with the valve open to the supply: the start factor is then the supply's
    CommandProgram program;
  };
  Inputs inputs_of(const Rig& rig, const Recording& recording) const;
  std::vector<Inputs> inputs_;
};

}  // namespace pneuservo
