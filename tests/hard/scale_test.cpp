#include "render/renderer.hpp"
#include "tests/hard/bodies.hpp"
#include "tests/render/picture.hpp"

namespace deforma {
namespace {

using namespace hard;

struct Outcome {
  std::vector<Vec3> displacement, force;  // over the size, over E d^2
  double step;                            // in d/c
};

// The cube, `scale` times as large, deformed and then simulated for some steps.
Outcome outcome_at(double scale, Gradient gradient) {
  const double d = spacing * scale;
  State state = lattice_particles(Vec3::Constant(6 * d), 6, 6, 6, density, 0.2);
  prepare(state, gradient);
  scramble(state, 0.05 * d);
  Outcome outcome;
  auto effects = make_effects(state, elastic(gradient));
  for (const Vec3& f : total_force(state, effects)) outcome.force.push_back(f / (young * d * d));
  Solver solver(std::move(state), std::move(effects), {});
  outcome.step = solver.stable_step() * wave_speed() / d;
  take_steps(solver, 20);
  EXPECT_TRUE(finite_everywhere(solver.state()));
  for (const Vec3& u : solver.state().particles.displacement) outcome.displacement.push_back(u / (6 * d));
  return outcome;
}

double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest / largest_norm(b);
}

TEST(HardCase, Row08ScaledFromAMicrometreToAThousandKilometres) {
  for (Gradient gradient : both_fits) {
    const Outcome one = outcome_at(1.0, gradient);
    for (int power = -6; power <= 6; ++power) {
      SCOPED_TRACE(testing::Message() << gradient_name(gradient) << ", scale 1e" << power);
      const Outcome other = outcome_at(std::pow(10.0, power), gradient);
      EXPECT_LT(difference(other.displacement, one.displacement), 1e-8);
      EXPECT_LT(difference(other.force, one.force), 1e-8);
      EXPECT_NEAR(other.step, one.step, 1e-8 * one.step);
    }
  }
}

Image picture_of(const State& state, const Vec3& origin) {
  std::vector<Vec3> points(state.surface.size()), normals(points.size());
  deform_surface(state.surface, state.particles, state.fit, state.F, points);
  vertex_normals(points, state.surface.triangles, normals);
  FrameContent frame;
  frame.camera.eye = origin + Vec3(1.5, -1.8, 1.2);
  frame.camera.target = origin + Vec3::Constant(3 * spacing);
  frame.meshes.push_back({points, normals, state.surface.triangles, Look{}});
  const DrawnGround ground{.height = origin.z()};
  frame.ground = &ground;
  RendererSettings settings;
  settings.width = 160;
  settings.height = 120;
  settings.detail.shadow_size = 256;
  return Renderer(settings).draw(frame);
}

TEST(HardCase, Row09BodyFarFromTheOrigin) {
  const double size = 6 * spacing, area = spacing * spacing;
  const Vec3 far = 1e5 * size * Vec3(1, -1, 1).normalized();
  for (Gradient gradient : both_fits) {
    SCOPED_TRACE(gradient_name(gradient));
    std::vector<Image> pictures;
    std::vector<std::vector<Vec3>> forces;
    for (const Vec3& origin : {Vec3(0, 0, 0), far}) {
      State state = cube_particles(0.2);
      pose_rest(state, Mat3::Identity(), origin);
      prepare(state, gradient);
      auto effects = make_effects(state, elastic(gradient));
      EXPECT_LT(largest_norm(total_force(state, effects)), 1e-4 * young * area) << "at rest";
      move_rigidly(state, Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix(), origin);
      for (std::size_t i = 0; i < state.size(); ++i) {  // about the body's own corner
        const Mat3 R = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();
        const Vec3 arm = state.particles.rest[i] - origin;
        state.particles.displacement[i] = R * arm - arm;
      }
      EXPECT_LT(largest_norm(total_force(state, effects)), 1e-4 * young * area) << "turned";
      scramble(state, 0.05 * spacing);
      forces.push_back(total_force(state, effects));
      Solver solver(std::move(state), std::move(effects), {});
      take_steps(solver, 20);
      EXPECT_TRUE(finite_everywhere(solver.state()));
      pictures.push_back(picture_of(solver.state(), origin));
    }
    double noise = 0.0;
    for (std::size_t i = 0; i < forces[0].size(); ++i)
      noise = std::max(noise, (forces[1][i] - forces[0][i]).norm());
    EXPECT_LT(noise, 1e-4 * young * area) << "deformed";
    // The render tests' tolerance: neighbouring levels of 8 bits, but for a few pixels at an edge, where a corner that
    // has moved by a rounding error can cover one more sample of four.
    EXPECT_LT(share_of_different(pictures[0], pictures[1], 2), 0.002);
    EXPECT_GT(share_of_different(pictures[0], Image{160, 120, std::vector<std::uint8_t>(4 * 160 * 120)}, 2),
              0.1);
  }
}

}  // namespace
}  // namespace deforma
