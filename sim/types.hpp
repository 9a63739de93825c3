#pragma once

#include <Eigen/Core>
#include <cstdint>

/// Every quantity in this program is in SI units (m, kg, s, N, Pa, J, K) unless its name says otherwise.
namespace deforma {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index = std::uint32_t;

/// Half-open interval of indices [begin, end).
struct Range {
  Index begin = 0;
  Index end = 0;

  Index size() const { return end - begin; }
  bool contains(Index i) const { return begin <= i && i < end; }
};

}  // namespace deforma
