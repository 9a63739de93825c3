#include "pipeline/value_range.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace deforma {

namespace {

constexpr double left_out = 0.005;  // of the values, on either side

// The upper half of a float's bits, turned so that they ascend with its value: sign, exponent and 7 bits of mantissa.
std::uint32_t ordered(std::uint32_t bits) { return bits >> 31 ? ~bits : bits | 0x80000000u; }
std::uint32_t unordered(std::uint32_t bits) { return bits >> 31 ? bits & 0x7fffffffu : ~bits; }

std::size_t bin_of(float value) { return ordered(std::bit_cast<std::uint32_t>(value)) >> 16; }
double middle_of(std::size_t bin) {
  return std::bit_cast<float>(unordered(static_cast<std::uint32_t>(bin) << 16 | 0x8000u));
}

/// 1, 2 or 5 times a power of ten, the largest that is at most `size`.
double round_step(double size) {
  const double power = std::pow(10.0, std::floor(std::log10(size)));
  const double digit = size / power;
  return (digit >= 5.0 ? 5.0 : digit >= 2.0 ? 2.0 : 1.0) * power;
}

}  // namespace

ValueRange::ValueRange(const FieldInfo& field, bool symmetric)
    : field_(&field), symmetric_(symmetric), bins_(65536, 0) {}

void ValueRange::add(std::span<const float> values) {
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    lowest_ = std::min<double>(lowest_, value);
    highest_ = std::max<double>(highest_, value);
    ++bins_[bin_of(static_cast<float>(value - field_->at_rest))];
    ++count_;
  }
}

double ValueRange::quantile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t passed = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    passed += bins_[bin];
    if (bins_[bin] > 0 && static_cast<double>(passed) >= wanted)
      return std::clamp(field_->at_rest + middle_of(bin), lowest_, highest_);
  }
  return highest_;
}

std::array<double, 2> ValueRange::range() const {
  const double rest = field_->at_rest;
  const bool grows = field_->least == rest;
  double low = count_ == 0 || grows ? rest : quantile(left_out);
  double high = count_ == 0 ? rest : quantile(1.0 - left_out);
  if (symmetric_ && !grows) {
    const double reach = std::max(std::abs(low - rest), std::abs(high - rest));
    low = rest - reach;
    high = rest + reach;
  }
  // Nothing to tell apart but rounding: any range will do.
  if (!(high - low > 1e-6 * std::abs(rest))) {
    low = grows ? rest : rest - 0.01;
    high = grows ? rest + 1.0 : rest + 0.01;
  }
  const double step = round_step((high - low) / 10.0);
  // A little slack, or a number that is round already would go one step farther.
  return {step * std::floor(low / step + 1e-3), step * std::ceil(high / step - 1e-3)};
}

}  // namespace deforma
