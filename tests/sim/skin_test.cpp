#include "sim/skin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "fixtures.hpp"

namespace deforma {
namespace {

State box(double jitter = 0.2) { return lattice_box(Vec3(0.5, 0.4, 0.6), 5, 4, 6, 1000.0, jitter); }

void displace(State& state, const Mat3& A, const Vec3& shift) {
  for (std::size_t i = 0; i < state.size(); ++i)
    state.particles.displacement[i] = A * state.particles.rest[i] + shift - state.particles.rest[i];
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
}

TEST(Skin, IsExactUnderAffineMotion) {
  State state = box();
  Mat3 A = (Mat3() << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.1).finished();
  displace(state, A, Vec3(1, -2, 3));
  std::vector<Vec3> points(state.surface.size());
  deform_surface(state.surface, state.particles, state.fit, state.F, points);
  for (std::size_t s = 0; s < points.size(); ++s)
    EXPECT_LT((points[s] - (A * state.surface.rest[s] + Vec3(1, -2, 3))).norm(), 1e-12);
}

TEST(Skin, FollowsRigidMotionOnAParticleAndFarFromAll) {
  State state = lattice_particles(Vec3(0.5, 0.4, 0.6), 5, 4, 6, 1000.0);
  state.surface.rest[0] = state.particles.rest[17];  // exactly on a particle
  state.surface.rest[1] = Vec3(20, 0, 0);            // 100 h away
  prepare_state(state, {});
  ASSERT_EQ(state.surface.skin.row(1).size(), 1u);
  Mat3 R = Eigen::AngleAxisd(1.0, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  displace(state, R, Vec3(0.1, 0, 0));
  std::vector<Vec3> points(state.surface.size());
  deform_surface(state.surface, state.particles, state.fit, state.F, points);
  for (std::size_t s : {0u, 1u})
    EXPECT_LT((points[s] - (R * state.surface.rest[s] + Vec3(0.1, 0, 0))).norm(), 1e-12 * 20);
}

TEST(Skin, WeightsAddUpToOneAndStayWithinTheBody) {
  State state = lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  append_body(state, lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0), Vec3(0.3, 0, 0));
  prepare_state(state, {});
  for (std::size_t s = 0; s < state.surface.size(); ++s) {
    double sum = 0.0;
    for (const Skin::Tie& tie : state.surface.skin.row(s)) {
      sum += tie.weight;
      EXPECT_EQ(state.particles.body[tie.particle], state.surface.body[s]);
    }
    EXPECT_NEAR(sum, 1.0, 1e-14);
  }
}

TEST(Skin, CarriesForceBackAsTheTransposeOfTheMotion) {
  // Virtual work: f_s . du_s summed over the surface equals f_i . du_i + (what P does) for any motion.
  State state = box();
  Surface& surface = state.surface;
  std::mt19937 generator(5);
  auto noise = [&] {
    return Vec3(generator() / 4294967296.0, generator() / 4294967296.0, generator() / 4294967296.0);
  };
  std::vector<Vec3> surface_force(surface.size());
  for (Index s = 0; s < surface.size(); ++s) {
    surface.active.push_back(s);
    surface_force[s] = noise();
  }
  for (Vec3& u : state.particles.displacement) u = noise();
  deformation_gradients(state.links, state.fit, state.particles.displacement, state.F);
  std::vector<Vec3> points(surface.size()), force(state.size(), Vec3::Zero());
  deform_surface(surface, state.particles, state.fit, state.F, points);
  double work = 0.0;
  for (std::size_t s = 0; s < surface.size(); ++s) work += surface_force[s].dot(points[s] - surface.rest[s]);
  std::vector<Mat3> P(state.size(), Mat3::Zero());
  add_surface_force(surface, state.fit, surface_force, P, force);
  double carried = 0.0;
  Vec3 total = Vec3::Zero(), expected = Vec3::Zero();
  for (std::size_t i = 0; i < state.size(); ++i) {
    carried += force[i].dot(state.particles.displacement[i]);
    carried -= state.fit.weight[i] * P[i].cwiseProduct(state.F[i] - Mat3::Identity()).sum();
    total += force[i];
  }
  for (const Vec3& f : surface_force) expected += f;
  EXPECT_NEAR(carried, work, 1e-12 * std::abs(work));
  EXPECT_LT((total - expected).norm(), 1e-12 * expected.norm());
}

TEST(Skin, NormalsPointOutwardAndSkipEmptyTriangles) {
  State state = box(0.0);
  std::vector<Vec3> normals(state.surface.size());
  auto triangles = state.surface.triangles;
  triangles.push_back({0, 0, 1});
  vertex_normals(state.surface.rest, triangles, normals);
  Vec3 centre(0.25, 0.2, 0.3);
  for (std::size_t s = 0; s < normals.size(); ++s) {
    EXPECT_NEAR(normals[s].norm(), 1.0, 1e-12);
    EXPECT_GT(normals[s].dot(state.surface.rest[s] - centre), 0.0);
  }
}

TEST(Skin, VertexAreasAddUpToTheSurface) {
  State state = box(0.0);
  double sum = 0.0;
  for (double area : state.surface.area) sum += area;
  EXPECT_NEAR(sum, 2 * (0.5 * 0.4 + 0.4 * 0.6 + 0.6 * 0.5), 1e-12);
}

TEST(Skin, RefusesABodyWithoutParticles) {
  State state = lattice_particles(Vec3::Ones(), 2, 2, 2, 1.0);
  state.bodies[0].particles = {0, 0};
  try {
    prepare_state(state, {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("body 'box'"));
  }
}

}  // namespace
}  // namespace deforma
