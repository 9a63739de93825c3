#include "render/camera.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <stdexcept>

namespace deforma {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Eigen::Vector3d in_picture(const Camera& camera, double aspect, const Eigen::Vector3d& point) {
  return (projection_matrix(camera, aspect, 1e-3, 1e6) * view_matrix(camera) * point.homogeneous())
      .hnormalized();
}

TEST(Camera, FramesAllCornersOfABox) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int round = 0; round < 200; ++round) {
    const Eigen::Vector3d middle(3.0 * any(random), 3.0 * any(random), 3.0 * any(random));
    const Eigen::Vector3d half = Eigen::Vector3d(any(random), any(random), any(random)).cwiseAbs();
    const Eigen::Vector3d direction(any(random), any(random), any(random));
    const double aspect = 1.0 + 0.8 * any(random);
    const double field_of_view = 40.0 + 30.0 * any(random);
    const Camera camera = frame_box(middle - half, middle + half, aspect, direction, field_of_view);
    double reach = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Eigen::Vector3d seen = in_picture(camera, aspect, middle + half.cwiseProduct(sign));
      EXPECT_LT(seen.cwiseAbs().maxCoeff(), 1.0);
      reach = std::max(reach, seen.head<2>().cwiseAbs().maxCoeff());
    }
    EXPECT_GT(reach, 0.6) << "the box fills the picture";
  }
}

TEST(Camera, FramesAPoint) {
  const Eigen::Vector3d point(1.0, 2.0, 3.0);
  EXPECT_LT(in_picture(frame_box(point, point, 1.5), 1.5, point).head<2>().norm(), 1e-9);
}

TEST(Camera, LooksAtItsTargetWithUpUpwards) {
  Camera camera;
  camera.eye = {4.0, 3.0, 2.0};
  camera.target = {1.0, 0.5, 0.25};
  EXPECT_LT(in_picture(camera, 1.7, camera.target).head<2>().norm(), 1e-12);
  EXPECT_GT(in_picture(camera, 1.7, camera.target + Eigen::Vector3d(0.0, 0.0, 0.1)).y(), 0.0);
  const Eigen::Matrix3d turn = view_matrix(camera).topLeftCorner<3, 3>();
  EXPECT_LT((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(Camera, LooksStraightDown) {
  Camera camera;
  camera.eye = {0.0, 0.0, 5.0};
  EXPECT_TRUE(view_matrix(camera).allFinite());
  const Eigen::Matrix3d turn = view_matrix(camera).topLeftCorner<3, 3>();
  EXPECT_NEAR(turn.determinant(), 1.0, 1e-14);
}

TEST(Camera, DepthRunsFromNearToFar) {
  const Camera camera;
  const auto depth = [&](double z) {
    return (projection_matrix(camera, 1.0, 0.5, 20.0) * Eigen::Vector4d(0.0, 0.0, -z, 1.0)).hnormalized().z();
  };
  EXPECT_NEAR(depth(0.5), -1.0, 1e-12);
  EXPECT_NEAR(depth(20.0), 1.0, 1e-12);
}

TEST(Camera, RefusesWhatCannotBeSeen) {
  const Eigen::Vector3d low(0, 0, 0), high(1, 1, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { frame_box(high, low, 1.0); }, ThrowsMessage<std::invalid_argument>(HasSubstr("box")));
  EXPECT_THAT(
      [&] {
        frame_box(low, {nan, 1, 1}, 1.0);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("box")));
  EXPECT_THAT([&] { frame_box(low, high, 0.0); }, ThrowsMessage<std::invalid_argument>(HasSubstr("aspect")));
  EXPECT_THAT(
      [&] {
        frame_box(low, high, 1.0, {0, 0, 0});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("direction")));
  EXPECT_THAT(
      [&] {
        frame_box(low, high, 1.0, {1, 0, 0}, 180.0);
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("field of view")));
  Camera blind;
  blind.eye = blind.target;
  EXPECT_THAT([&] { view_matrix(blind); }, ThrowsMessage<std::invalid_argument>(HasSubstr("eye and target")));
  EXPECT_THAT([&] { projection_matrix(Camera(), 1.0, 2.0, 1.0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("near plane")));
}

}  // namespace
}  // namespace deforma
