// Smooth interpolation of sampled positions: piecewise polynomials of degree 7 with three continuous derivatives.
#pragma once
#include <array>
#include <vector>

namespace pneuservo {

/// One polynomial per interval, coefficients ascending in w = (t - t_i)/(t_(i+1) - t_i). At every sample the position
/// is the sample's, and derivatives 1 to 3 are those of the polynomial through the seven nearest samples (fewer where
/// there are fewer); so polynomials up to degree 6 come out exactly. times_s strictly increasing, at least two.
std::vector<std::array<double, 8>> interpolate_septic(const std::vector<double>& times_s, const std::vector<double>& positions_m);

}  // namespace pneuservo
