#include "sim/kernel.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace deforma {

namespace {

constexpr std::array<std::string_view, 5> names = {"poly6", "gaussian", "cubic_spline", "quartic",
                                                   "wide_cubic_spline"};
constexpr double pi = std::numbers::pi;

// Eq 13 without its factor; integrates to pi h^3 / 12.
double cubic_spline_shape(double q) {
  if (q < 0.5) return 2.0 / 3.0 - 4.0 * q * q + 4.0 * q * q * q;
  double s = 1.0 - q;
  return 4.0 / 3.0 * s * s * s;
}

}  // namespace

double kernel_weight(Kernel kernel, double q) {
  if (q >= 1.0) return 0.0;
  switch (kernel) {
    case Kernel::poly6: {  // eq 11
      double s = 1.0 - q * q;
      return 315.0 / (64.0 * pi) * s * s * s;
    }
    case Kernel::gaussian:  // eq 12, cut at h
      return std::exp(-q * q / 0.16) / 0.354287260963;
    case Kernel::cubic_spline:       // eq 13
    case Kernel::wide_cubic_spline:  // eq 15, its support of 2h taken as the support radius
      return 12.0 / pi * cubic_spline_shape(q);
    case Kernel::quartic: {  // eq 14: 1 - 6 q^2 + 8 q^3 - 3 q^4
      double s = 1.0 - q;
      return 105.0 / (16.0 * pi) * (1.0 + 3.0 * q) * s * s * s;
    }
  }
  throw std::invalid_argument(fmt::format("kernel {} is none of 1 to 5", static_cast<int>(kernel)));
}

double kernel_weight(Kernel kernel, double r, double h) { return kernel_weight(kernel, r / h) / (h * h * h); }

Kernel kernel_from_name(std::string_view name) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return static_cast<Kernel>(k + 1);
  throw std::invalid_argument(fmt::format("unknown kernel '{}' (allowed: {})", name, fmt::join(names, ", ")));
}

std::string_view kernel_name(Kernel kernel) { return names.at(static_cast<std::size_t>(kernel) - 1); }

std::span<const std::string_view> kernel_names() { return names; }

}  // namespace deforma
