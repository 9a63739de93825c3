#pragma once

#include <cstddef>
#include <vector>

#include "sim/state.hpp"

namespace deforma {

/// Memory that an array holds [bytes].
template <typename T>
std::size_t bytes_of(const std::vector<T>& array) {
  return array.capacity() * sizeof(T);
}

/// What strain takes: links, fit and deformation gradients [bytes].
std::size_t strain_bytes(const State& state);

/// What a surface and its ties to the particles take [bytes].
std::size_t surface_bytes(const Surface& surface);

/// What the particles themselves take [bytes].
std::size_t particle_bytes(const Particles& particles);

}  // namespace deforma
