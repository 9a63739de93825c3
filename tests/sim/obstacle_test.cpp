#include "sim/obstacle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "fixtures.hpp"
#include "sim/obstacle_motion.hpp"
#include "sphere_mesh.hpp"

namespace deforma {
namespace {

MeshShape box_mesh(const Vec3& size) {
  Surface surface;
  add_box_surface(surface, size, {3, 2, 4});
  for (Vec3& p : surface.rest) p -= 0.5 * size;
  return {surface.rest, surface.triangles};
}

std::vector<std::pair<std::string, ObstacleShape>> every_shape() {
  return {{"plane", PlaneShape{Vec3(1, 2, 3)}},
          {"box", BoxShape{Vec3(1, 0.8, 1.4), false, false}},
          {"container box", BoxShape{Vec3(1, 0.8, 1.4), true, false}},
          {"open container box", BoxShape{Vec3(1, 0.8, 1.4), true, true}},
          {"cylinder", CylinderShape{0.5, 1.2, false, false}},
          {"container cylinder", CylinderShape{0.5, 1.2, true, false}},
          {"open container cylinder", CylinderShape{0.5, 1.2, true, true}},
          {"sphere", SphereShape{0.6, false}},
          {"container sphere", SphereShape{0.6, true}},
          {"mesh", box_mesh(Vec3(1, 0.8, 1.4))}};
}

std::vector<Touch> touches_of(const ObstacleShape& shape, const Vec3& point) {
  std::vector<Touch> touches;
  ObstacleField(Obstacle{.name = "it", .shape = shape}).find(point, touches);
  return touches;
}

class Random {
 public:
  double in(double a, double b) { return a + (b - a) * (generator_() / 4294967296.0); }
  Vec3 point(double reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }
  Vec3 direction() {
    for (;;) {
      Vec3 p = point(1.0);
      if (p.norm() <= 1.0 && p.norm() > 0.01) return p.normalized();
    }
  }

 private:
  std::mt19937 generator_{3};
};

TEST(Obstacle, DepthGrowsAgainstTheNormalAtUnitRate) {
  Random random;
  for (const auto& [name, shape] : every_shape()) {
    int checked = 0;
    for (int k = 0; k < 2000; ++k) {
      Vec3 p = random.point(1.0);
      std::vector<Touch> touches = touches_of(shape, p);
      double h = 1e-5;
      for (std::size_t t = 0; t < touches.size(); ++t) {
        EXPECT_NEAR(touches[t].normal.norm(), 1.0, 1e-12) << name;
        Vec3 gradient;
        bool smooth = true;  // the same touches all around, none switching to another wall
        for (int axis = 0; axis < 3; ++axis) {
          auto more = touches_of(shape, p + h * Vec3::Unit(axis)),
               less = touches_of(shape, p - h * Vec3::Unit(axis));
          smooth = smooth && more.size() == touches.size() && less.size() == touches.size() &&
                   more[t].normal.dot(touches[t].normal) > 0.99 &&
                   less[t].normal.dot(touches[t].normal) > 0.99;
          if (smooth) gradient[axis] = (more[t].depth - less[t].depth) / (2.0 * h);
        }
        if (!smooth) continue;
        EXPECT_LT((gradient + touches[t].normal).norm(), 1e-6) << name << " at " << p.transpose();
        ++checked;
      }
    }
    EXPECT_GT(checked, 100) << name;
  }
}

TEST(Obstacle, NothingTouchesWithinTheClearance) {
  Random random;
  for (const auto& [name, shape] : every_shape()) {
    ObstacleField field(Obstacle{.name = "it", .shape = shape});
    for (int k = 0; k < 300; ++k) {
      Vec3 p = random.point(1.5);
      double clearance = field.clearance(p);
      std::vector<Touch> touches;
      field.find(p, touches);
      EXPECT_EQ(touches.empty(), clearance > 0.0) << name;
      if (!touches.empty() || std::isinf(clearance)) continue;
      bool reached = false;  // and just beyond it something does, so the bound is of use
      for (int d = 0; d < 50; ++d) field.find(p + 0.999999 * clearance * random.direction(), touches);
      EXPECT_TRUE(touches.empty()) << name << " at " << p.transpose();
      for (int d = 0; d < 400 && !reached; ++d) {
        field.find(p + 1.5 * clearance * random.direction(), touches);
        reached = !touches.empty();
      }
      EXPECT_TRUE(reached) << name << " at " << p.transpose();
    }
  }
}

TEST(Obstacle, KnownPlaces) {
  auto plane = touches_of(PlaneShape{Vec3(0, 0, 2)}, Vec3(5, 5, -0.25));
  ASSERT_EQ(plane.size(), 1u);
  EXPECT_DOUBLE_EQ(plane[0].depth, 0.25);
  auto box = touches_of(BoxShape{Vec3(2, 2, 2), false, false}, Vec3(0.1, -0.8, 0.3));
  ASSERT_EQ(box.size(), 1u);
  EXPECT_DOUBLE_EQ(box[0].depth, 1.0 - 0.8);
  EXPECT_EQ(box[0].normal, Vec3(0, -1, 0));
  auto cylinder = touches_of(CylinderShape{1.0, 4.0, true, false}, Vec3(0, 1.5, 0));
  ASSERT_EQ(cylinder.size(), 1u);
  EXPECT_DOUBLE_EQ(cylinder[0].depth, 0.5);
  EXPECT_EQ(cylinder[0].normal, Vec3(0, -1, 0));
  auto center = touches_of(SphereShape{1.0, false}, Vec3::Zero());
  ASSERT_EQ(center.size(), 1u);
  EXPECT_DOUBLE_EQ(center[0].depth, 1.0);
  EXPECT_DOUBLE_EQ(center[0].normal.norm(), 1.0);
}

TEST(Obstacle, AContainersCornerTouchesOncePerWall) {
  EXPECT_EQ(touches_of(BoxShape{Vec3(1, 1, 1), true, false}, Vec3(0.6, -0.7, 0.8)).size(), 3u);
  EXPECT_EQ(touches_of(BoxShape{Vec3(1, 1, 1), true, true}, Vec3(0.6, -0.7, 0.8)).size(), 2u);
  EXPECT_EQ(touches_of(CylinderShape{0.5, 1.0, true, false}, Vec3(0.4, 0.5, -0.8)).size(), 2u);
  EXPECT_EQ(touches_of(CylinderShape{0.5, 1.0, true, true}, Vec3(0.1, 0.1, 7.0)).size(), 0u);
  EXPECT_EQ(touches_of(CylinderShape{0.5, 1.0, true, true}, Vec3(0.4, 0.5, 7.0)).size(), 1u);
}

TEST(Obstacle, AMeshOfABoxIsThatBox) {
  Vec3 size(1, 0.8, 1.4);
  ObstacleField mesh(Obstacle{.name = "mesh", .shape = box_mesh(size)});
  ObstacleField box(Obstacle{.name = "box", .shape = BoxShape{size, false, false}});
  Random random;
  for (int k = 0; k < 2000; ++k) {
    Vec3 p = random.point(1.0);
    EXPECT_NEAR(mesh.clearance(p), box.clearance(p), 1e-12);
    std::vector<Touch> a, b;
    mesh.find(p, a);
    box.find(p, b);
    ASSERT_EQ(a.size(), b.size()) << p.transpose();
    for (std::size_t t = 0; t < a.size(); ++t) {
      EXPECT_NEAR(a[t].depth, b[t].depth, 1e-12);
      EXPECT_LT((a[t].normal - b[t].normal).norm(), 1e-9);
    }
  }
}

TEST(Obstacle, AMeshOfASphereIsNearlyThatSphere) {
  ObstacleField mesh(Obstacle{.name = "mesh", .shape = sphere_mesh(0.5, 5)});
  ObstacleField sphere(Obstacle{.name = "sphere", .shape = SphereShape{0.5, false}});
  Random random;
  for (int k = 0; k < 1000; ++k) {
    Vec3 p = random.in(0.2, 0.49) * random.direction();
    std::vector<Touch> a, b;
    mesh.find(p, a);
    sphere.find(p, b);
    ASSERT_EQ(a.size(), 1u);
    EXPECT_NEAR(a[0].depth, b[0].depth, 1e-3);
    EXPECT_GT(a[0].normal.dot(b[0].normal), 0.99);
  }
}

TEST(Obstacle, PoseFollowsItsKeyframes) {
  using Key = Curve<Vec3>::Key;
  Obstacle obstacle{.name = "door", .shape = PlaneShape{Vec3::UnitX()}};
  obstacle.position = Curve<Vec3>(std::vector<Key>{{0.0, Vec3(0, 0, 0)}, {2.0, Vec3(0, 4, 0)}});
  obstacle.rotation =
      Curve<Vec3>(std::vector<Key>{{0.0, Vec3(0, 0, 0)}, {2.0, Vec3(0, 0, std::numbers::pi)}});
  Pose half = obstacle.pose_at(1.0);
  EXPECT_LT((half.position - Vec3(0, 2, 0)).norm(), 1e-14);
  EXPECT_LT((half.rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-14);

  ObstacleMotion motion(obstacle);
  Vec3 point(0.3, -0.2, 0.1);
  auto material_at = [&](double time) -> Vec3 {  // the place of what is at `point` at t = 1
    Vec3 local = half.rotation.transpose() * (point - half.position);
    Pose pose = obstacle.pose_at(time);
    return pose.position + pose.rotation * local;
  };
  motion.move_to(1.0);
  Vec3 expected = (material_at(1.0 + 1e-6) - material_at(1.0 - 1e-6)) / 2e-6;
  EXPECT_LT((motion.velocity_at(point) - expected).norm(), 1e-8);
}

TEST(Obstacle, RefusesAMeshWithoutTriangles) {
  try {
    ObstacleField field(Obstacle{.name = "nothing", .shape = MeshShape{}});
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("at least one triangle"));
  }
}

}  // namespace
}  // namespace deforma
