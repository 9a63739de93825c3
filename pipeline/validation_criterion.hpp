#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace deforma {

/// How a measured value is held against its reference.
enum class Comparison {
  relative,  ///< by |value / reference - 1|
  at_most    ///< by the value itself, which is an error or a cost; the reference says what it should be
};

/// Goal and limit of the error; infinity where there is none.
struct Bounds {
  double goal;
  double limit;
};

/// One quantity that a case measures, what it should be, and how far off it may be.
struct Criterion {
  std::string_view case_name;
  std::string_view quantity;
  std::string_view unit;
  Comparison comparison;
  double reference;
  Bounds coarse;            ///< fewer than 6 particles across
  Bounds fine;              ///< 6 and more
  std::string_view source;  ///< of the reference

  const Bounds& bounds(int n) const { return n < 6 ? coarse : fine; }

  /// The error [-]: signed for a relative comparison.
  double error(double value) const;
};

/// Every quantity of every case: the one place where goals and limits stand, in the table's order.
const std::vector<Criterion>& validation_criteria();

/// @throws std::out_of_range when a case has no such quantity.
const Criterion& find_criterion(std::string_view case_name, std::string_view quantity);

/// Of the settings that are judged.
enum class Verdict {
  ok,      ///< within the goal
  missed,  ///< the goal, but not the limit
  failed,  ///< beyond the limit, or no value
  shown    ///< neither goal nor limit
};

std::string_view verdict_name(Verdict verdict);

/// @param value not a number when there is none
Verdict judge(const Criterion& criterion, int n, double value);

/// Largest strain allowed in a case whose reference holds for small strain.
inline constexpr double small_strain = 1e-3;

}  // namespace deforma
