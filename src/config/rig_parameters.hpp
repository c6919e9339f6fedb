// All numbers of a rig by their config path (line_1.length_m, effects.sensor_offset:x.offset), from the same fields.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// One number of a rig.
struct ParameterPath {
  std::string path;
  Field field;   ///< unit, range, help
  double value;
};

/// Every number that the rig has, in the order of the config; all effects are there, neutral where it is silent.
/// Numbers that are optional and not stated (initial.pressure_2_Pa) are left out.
std::vector<ParameterPath> parameter_paths(const Rig& rig);

/// A number of a rig whose path is resolved once: it then reads and sets that number in any rig of the same kind that
/// states the same sections, without a walk over their names.
class ParameterHandle {
 public:
  /// Throws InputError for a path that the rig does not have, with near ones.
  ParameterHandle(const Rig& rig, std::string_view path);
  const std::string& path() const { return path_; }
  const Field& field() const { return field_; }
  /// Throws InputError where an optional number is not stated.
  double value(const Rig& rig) const;
  /// Throws InputError for a value that is not finite or out of the field's range.
  void set(Rig& rig, double value) const;

 private:
  std::string path_;
  Field field_;
  std::size_t offset_ = 0;  ///< of the number in the rig
  bool is_inside_ = false;  ///< else it lies behind a vector and is found by its path
  bool is_optional_ = false;
};

/// Value at a path. Throws InputError for a path that the rig does not have, with near ones.
double get_parameter(const Rig& rig, std::string_view path);

/// Sets the number at a path, also one that was not stated. Throws InputError for an unknown path or a value that is
/// not finite or out of the field's range; relations between values are not checked again.
void set_parameter(Rig& rig, std::string_view path, double value);

/// Whether the path names a number of this rig, stated or not.
bool has_parameter(const Rig& rig, std::string_view path);

/// The rig that a simulation runs: every number under `deviations` times 1 + its deviation, and what stands under
/// `concealed` in place of the known effects. What the config says beside is what controller and estimator believe.
Rig simulated_rig(const Rig& rig);

/// Makes all effects of the axis and of its sensors neutral.
void without_effects(Rig& rig);

}  // namespace pneuservo
