// What the rows of the thesis are computed with: designs, runs of the axis, runs of linear models; each once.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <pneuservo/control/linear_servo_table.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

struct AxisDesign;

/// A config of the folder, and what is changed in it.
struct ThesisRig {
  std::string config;  ///< below the folder, without .yaml
  std::vector<std::string> sets{};
  int moves = 1;  ///< the last one counts
};

/// A motion over time, every tick.
struct ThesisCourse {
  std::vector<double> t_s, x_ref_m, x_m, u_V;
  std::array<std::vector<double>, 2> port_Pa, chamber_Pa, estimated_Pa;
  double from_s = 0.0, to_s = 0.0;  ///< what is judged
  double max_error_m = 0.0, end_error_m = 0.0, max_estimation_error_Pa = 0.0, ripple_Pa = 0.0;
  double mean_pressure_Pa = 0.0;    ///< of both chambers at the end
  std::string fault{};              ///< the first one; empty: none
};

/// A linear model as the plant. The law: ideal derivatives and the feedforward of t_k, as printed, or the config's own.
struct LinearRun {
  ThesisRig rig;
  Ppd2Gains gains;
  int feedforward_order = 0;  ///< 0: none; of ideal derivatives
  int plant_order = 7;  ///< 3: no lags; 5: one matched lag; 7: valve and line
  enum class Law { ideal, config } law = Law::ideal;
};

class ThesisBench {
 public:
  /// `folder` holds the shipped configs.
  explicit ThesisBench(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Throws InputError as read_rig does.
  Rig rig(const ThesisRig& which) const;
  const ThesisCourse& run(const ThesisRig& which);
  const ThesisCourse& run(const LinearRun& which);
  /// The plant of a cylinder alone under the command of another's run, as the verb simulate does it.
  const ThesisCourse& simulate(const ThesisRig& which, const ThesisRig& commanded);
  const AxisDesign& design(const ThesisRig& which);
  /// A figure that several rows share, by its name.
  double shared(const std::string& name, const std::function<double()>& make);

 private:
  template <class T> class Memory {
   public:
    const T& once(const std::string& name, const std::function<T()>& make);

   private:
    std::mutex mutex_;
    std::map<std::string, std::shared_future<std::shared_ptr<const T>>> known_;
  };
  std::filesystem::path folder_;
  Memory<ThesisCourse> courses_;
  Memory<AxisDesign> designs_;
  Memory<double> figures_;
};

/// "pneuservo run config/NAME.yaml --set ...", and the same of another verb.
std::string thesis_verb(const char* verb, const ThesisRig& which);

/// Largest |a(t) - b(t)| of two positions [m] in the window of the first.
double largest_apart_m(const ThesisCourse& a, const ThesisCourse& b);
/// Largest |port - chamber| of one side, or of both (side -1) [Pa], in the window.
double largest_loss_Pa(const ThesisCourse& course, int side = -1);
}  // namespace pneuservo
