#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim/fields.hpp"

namespace deforma {

/// Finds the range of a colour scale for any number of values, in a memory that does not grow with them: they are
/// counted in bins that are a hundredth of the distance from the field's value at rest wide.
class ValueRange {
 public:
  /// @param symmetric whether the range is to have the value at rest in its middle, as a diverging map needs
  ValueRange(const FieldInfo& field, bool symmetric);

  /// Values that are not finite do not count.
  void add(std::span<const float> values);

  double lowest() const { return lowest_; }    ///< inf before the first value
  double highest() const { return highest_; }  ///< -inf before the first value

  /// All but the outermost half per cent of the values on either side, so that a single corner or a single impact does not
  /// leave the rest in one colour, out to round numbers. A field that is never below its value at rest starts there.
  std::array<double, 2> range() const;

 private:
  double quantile(double share) const;

  const FieldInfo* field_;
  bool symmetric_;
  std::vector<std::uint64_t> bins_;
  std::uint64_t count_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace deforma
