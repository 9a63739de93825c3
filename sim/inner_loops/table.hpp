#pragma once

#include "sim/inner_loops/gathers.hpp"
#include "sim/inner_loops/strain.hpp"

namespace deforma {
namespace {

constexpr InnerLoops inner_loops = {linear_gradient,    quadratic_gradient, survey,
                                    neo_hookean,        linear_carry,       linear_force,
                                    quadratic_residual, quadratic_force};

}  // namespace
}  // namespace deforma
