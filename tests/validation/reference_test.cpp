#include "pipeline/validation_reference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/validation_criterion.hpp"

namespace deforma {
namespace {

using std::numbers::pi;

double reference_of(std::string_view case_name, std::string_view quantity) {
  return find_criterion(case_name, quantity).reference;
}

/// Timoshenko's beam in vibration, w and the rotation psi as exp(k x): two real and two imaginary wave numbers for a
/// frequency below the shear cut-off.
class TimoshenkoBar {
 public:
  TimoshenkoBar(double width, double young, double poisson, double density)
      : EI_(young * std::pow(width, 4) / 12.0),
        shear_(reference::shear_factor(poisson) * young / (2.0 * (1.0 + poisson)) * width * width),
        mass_(density * width * width),
        rotary_(density * std::pow(width, 4) / 12.0) {}

  /// Determinant of the end conditions of a bar of 1 m: its zeros are the natural frequencies.
  double determinant(double frequency, bool clamped) const {
    const double square = std::pow(2.0 * pi * frequency, 2);
    // EI w'''' + (mass EI / shear + rotary) square w'' - mass square (1 - rotary square / shear) w = 0
    const double b = square * (mass_ / shear_ + rotary_ / EI_);
    const double c = mass_ * square / EI_ * (1.0 - rotary_ * square / shear_);
    const double root = std::sqrt(0.25 * b * b + c);
    const double p = std::sqrt(root - 0.5 * b), q = std::sqrt(root + 0.5 * b);
    // psi = (w' + mass square / shear * integral of w), for the four functions cosh px, sinh px, cos qx, sin qx.
    const double s = mass_ * square / shear_;
    const double P = p + s / p, Q = q - s / q;
    const double ch = std::cosh(p), sh = std::sinh(p), co = std::cos(q), si = std::sin(q);
    Eigen::Matrix4d M;
    if (clamped)
      M.topRows(2) << 1, 0, 1, 0, 0, P, 0, Q;  // w = psi = 0
    else
      M.topRows(2) << P * p, 0, -Q * q, 0, 0, s / p, 0, -s / q;  // psi' = 0, psi - w' = 0
    M.row(2) << P * p * ch, P * p * sh, -Q * q * co, -Q * q * si;
    M.row(3) << s / p * sh, s / p * ch, s / q * si, -s / q * co;
    return M.determinant();
  }

  /// The first zero above `from` [Hz].
  double first_frequency(bool clamped, double from) const {
    double step = 0.01, f = from;
    const double sign = determinant(f, clamped);
    while (determinant(f, clamped) * sign > 0.0) f += step;
    return f;
  }

 private:
  double EI_, shear_, mass_, rotary_;
};

TEST(ValidationReference, TimoshenkosBeamBendsAndShears) {
  EXPECT_NEAR(reference::shear_factor(0.0), 10.0 / 12.0, 1e-15);
  EXPECT_NEAR(reference::shear_factor(0.3), 13.0 / 15.3, 1e-15);
  // L = 1, a = 0.2, E = 1e6, nu = 0.3: PL^3/3EI = 0.0025, PL/kappa G A = 7.65e-5 for 1 N.
  EXPECT_NEAR(reference::end_loaded_tip(1.0, 1.0, 0.2, 1e6, 0.3), 0.0025 + 15.3 / 13.0 * 2.6 / 4e4, 1e-15);
  EXPECT_NEAR(reference::end_loaded_tip(2.0, 1.0, 0.2, 1e6, 0.3),
              2.0 * reference::end_loaded_tip(1.0, 1.0, 0.2, 1e6, 0.3), 1e-15);
}

TEST(ValidationReference, TheDroppedBeamsSagIsTimoshenkos) {
  double sag = reference::sag_under_weight(1000.0 * 0.25 * 0.25 * 9.81, 1.0, 0.25, 5e6, 0.33);
  EXPECT_NEAR(2.0 * sag, reference_of("dropped-beam", "twice the mean sag (Timoshenko)"), 5e-5);
  // The solid is a little stiffer than the beam.
  EXPECT_NEAR(reference_of("dropped-beam", "twice the mean sag") / (2.0 * sag), 1.0, 0.03);
}

TEST(ValidationReference, TheTorsionConstantIsThatOfTheTable) {
  EXPECT_NEAR(reference::square_torsion_constant(), 0.1406, 5e-5);
}

/// J of the unit square from Prandtl's stress function: laplace phi = -2, phi = 0 on the boundary, J = 2 integral phi; by
/// finite differences on m x m cells, over-relaxed.
double prandtl_torsion_constant(int m) {
  auto row = static_cast<std::size_t>(m) + 1;
  std::vector<double> phi(row * row, 0.0);
  for (int sweep = 0; sweep < 600; ++sweep)
    for (std::size_t i = 1; i + 1 < row; ++i)
      for (std::size_t j = 1; j + 1 < row; ++j) {
        double* here = &phi[i * row + j];
        double next = 0.25 * (*(here - 1) + *(here + 1) + *(here - row) + *(here + row) + 2.0 / (m * m));
        *here += 1.93 * (next - *here);
      }
  double sum = 0.0;
  for (double value : phi) sum += value;
  return 2.0 * sum / (m * m);
}

TEST(ValidationReference, TorsionConstantSolvesPrandtlsEquation) {
  // The differences' error falls as 1/m^2: extrapolated.
  const double coarse = prandtl_torsion_constant(48), fine = prandtl_torsion_constant(96);
  EXPECT_NEAR((4.0 * fine - coarse) / 3.0, reference::square_torsion_constant(), 1e-6);
}

TEST(ValidationReference, TheElasticaIsThatOfTheTables) {
  const std::pair<double, double> known[] = {{1.0, 0.3017}, {2.0, 0.4935}, {5.0, 0.7138}, {10.0, 0.8106}};
  for (const auto& [load, deflection] : known)
    EXPECT_NEAR(reference::elastica_tip(load), deflection, 5e-5) << load;
}

TEST(ValidationReference, TheElasticaBeginsAsALinearBeam) {
  EXPECT_NEAR(reference::elastica_tip(1e-3), 1e-3 / 3.0, 1e-9);
}

TEST(ValidationReference, BendingFrequenciesAreNearTimoshenkos) {
  const TimoshenkoBar bar(0.2, 1e6, 0.3, 1.0);
  EXPECT_NEAR(reference_of("free-bar", "first bending") / bar.first_frequency(false, 20.0), 1.0, 0.01);
  // The solid's fully clamped root holds Poisson's contraction back too.
  EXPECT_NEAR(reference_of("clamped-bar", "first bending") / bar.first_frequency(true, 5.0), 1.0, 0.01);
}

TEST(ValidationReference, TheDroppedBeamSwingsAsTimoshenkos) {
  const TimoshenkoBar beam(0.25, 5e6, 0.33, 1000.0);
  EXPECT_NEAR(reference_of("dropped-beam", "period (Timoshenko)") * beam.first_frequency(true, 0.5), 1.0,
              0.005);
}

TEST(ValidationReference, TorsionFrequencyIsNearTheThinBars) {
  // f = sqrt(GJ / rho Ip) / 2L; the solid's end faces warp freely.
  const double shear = 1e6 / 2.6, polar = std::pow(0.2, 4) / 6.0;
  const double J = reference::square_torsion_constant() * std::pow(0.2, 4);
  EXPECT_NEAR(reference_of("free-bar", "first torsion") / (0.5 * std::sqrt(shear * J / polar)), 1.0, 0.005);
}

}  // namespace
}  // namespace deforma
