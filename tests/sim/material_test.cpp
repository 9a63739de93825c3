#include "sim/material.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace deforma {
namespace {

const Lame lame = lame_constants(2.0e5, 0.3);
const Mat3 deformed = (Mat3() << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1).finished();

class EveryMaterial : public testing::TestWithParam<int> {
 protected:
  Material material() const { return static_cast<Material>(GetParam()); }
};

TEST_P(EveryMaterial, StressIsTheDerivativeOfTheEnergy) {
  for (Mat3 F : {deformed, Mat3(-0.7 * deformed), Mat3(deformed * Vec3(1, 1, -0.5).asDiagonal())}) {
    Mat3 P = first_piola_kirchhoff(material(), lame, F);
    for (int e = 0; e < 9; ++e) {
      Mat3 forth = F, back = F;
      forth(e) += 1e-5;
      back(e) -= 1e-5;
      double slope =
          (energy_density(material(), lame, forth) - energy_density(material(), lame, back)) / 2e-5;
      EXPECT_NEAR(P(e), slope, 1e-6 * P.norm());
    }
  }
}

TEST_P(EveryMaterial, IsHookesLawAtSmallStrain) {
  Mat3 e = 1e-6 * (Mat3() << 1, 0.4, -0.2, 0.4, -2, 0.3, -0.2, 0.3, 0.5).finished();
  Mat3 hooke = lame.lambda * e.trace() * Mat3::Identity() + 2.0 * lame.mu * e;
  Mat3 P = first_piola_kirchhoff(material(), lame, Mat3::Identity() + e);
  EXPECT_LT((P - hooke).norm(), 1e-5 * hooke.norm());
}

TEST_P(EveryMaterial, GivesNoStressAndNoEnergyUnderRotation) {
  Mat3 R = Eigen::AngleAxisd(2.5, Vec3(3, 1, -2).normalized()).toRotationMatrix();
  EXPECT_LT(first_piola_kirchhoff(material(), lame, R).norm(), 1e-14 * lame.mu * 10);
  EXPECT_NEAR(energy_density(material(), lame, R), 0.0, 1e-14 * lame.mu);
}

TEST_P(EveryMaterial, ExertsNoTorque) {
  Mat3 tau = first_piola_kirchhoff(material(), lame, deformed) * deformed.transpose();
  EXPECT_LT((tau - tau.transpose()).norm(), 1e-13 * tau.norm());
}

TEST_P(EveryMaterial, IsFiniteForASingularGradient) {
  for (Mat3 F : {Mat3(Mat3::Zero()), Mat3(Vec3(1, 1, 0).asDiagonal()), Mat3(Vec3(1, 0, 0).asDiagonal())})
    EXPECT_TRUE(first_piola_kirchhoff(material(), lame, F).allFinite());
}

TEST_P(EveryMaterial, KeepsItsNameBothWays) {
  EXPECT_EQ(material_from_name(material_names()[static_cast<std::size_t>(GetParam())]), material());
}

INSTANTIATE_TEST_SUITE_P(Material, EveryMaterial, testing::Range(0, 3));

TEST(Material, NeoHookeanPushesAReflectedElementBack) {
  // Along the path from reflected to right way round, the energy of the default material only falls.
  double before = energy_density(Material::neo_hookean, lame, Vec3(1, 1, -1).asDiagonal().toDenseMatrix());
  for (double s = -0.98; s <= 1.0; s += 0.02) {
    double now = energy_density(Material::neo_hookean, lame, Vec3(1, 1, s).asDiagonal().toDenseMatrix());
    EXPECT_LT(now, before);
    before = now;
  }
}

TEST(Material, StVenantKirchhoffIsBlindToReflection) {
  Mat3 reflected = Vec3(1, 1, -1).asDiagonal();
  EXPECT_EQ(energy_density(Material::st_venant_kirchhoff, lame, reflected), 0.0);
}

TEST(Material, ASheetIsInPlaneStressAndARopeInAxialStress) {
  double e = 1e-6;
  Mat3 Q2 = Vec3(1, 1, 0).asDiagonal(), F2 = Q2;
  F2(0, 0) += e;
  double sheet = reduced_first_piola_kirchhoff(lame, F2, Q2, 2)(0, 0);
  EXPECT_NEAR(sheet, 2.0e5 / (1 - 0.09) * e, 1e-5 * sheet);
  Mat3 Q1 = Vec3(1, 0, 0).asDiagonal(), F1 = (1 + e) * Q1;
  double rope = reduced_first_piola_kirchhoff(lame, F1, Q1, 1)(0, 0);
  EXPECT_NEAR(rope, 2.0e5 * e, 1e-5 * rope);
}

TEST(Material, NearestRotationIsProperEvenForSingularAndReflectedGradients) {
  for (Mat3 F :
       {deformed, Mat3(Vec3(1, 1, -1).asDiagonal()), Mat3(Vec3(2, 0, 0).asDiagonal()), Mat3(Mat3::Zero())}) {
    Mat3 R = nearest_rotation(F);
    EXPECT_LT((R.transpose() * R - Mat3::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
  }
}

TEST(Material, RefusesAnUnknownNameWithTheList) {
  try {
    material_from_name("jelly");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'jelly' (allowed: neo_hookean"));
  }
}

}  // namespace
}  // namespace deforma
