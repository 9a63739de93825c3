#pragma once

#include <span>
#include <string_view>

namespace deforma {

/// The five weight functions of the paper (eqs 11-15). All have support radius h and integrate to 1 in 3D.
enum class Kernel { poly6 = 1, gaussian = 2, cubic_spline = 3, quartic = 4, wide_cubic_spline = 5 };

/// W(r, h) [m^-3], zero for r >= h.
///
/// Eq 15 as printed has support 2h; with h defined as the support radius it equals the cubic spline of eq 13.
/// @param r distance [m], not negative
/// @param h support radius [m], positive
double kernel_weight(Kernel kernel, double r, double h);

/// The same weight with the distance in support radii and no dimension: W(q, 1).
double kernel_weight(Kernel kernel, double q);

/// @throws std::invalid_argument for a name that is no kernel; the message lists the names.
Kernel kernel_from_name(std::string_view name);
std::string_view kernel_name(Kernel kernel);
std::span<const std::string_view> kernel_names();

}  // namespace deforma
