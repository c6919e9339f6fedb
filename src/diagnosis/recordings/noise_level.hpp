// What no motion explains of a sampled signal.
#pragma once
#include <vector>

namespace pneuservo {

/// Standard deviation of one sample [unit of the signal] in the quietest stretches: a tenth of them has less. Stretches
/// are of 0.25 s and at least 40 samples; samples without a value are left out.
double quiet_noise(const std::vector<double>& signal, double period_s);

/// The same in the usual stretch: half of them have less. Of a signal whose noise is absent at rest.
double usual_noise(const std::vector<double>& signal, double period_s);

}  // namespace pneuservo
