#include "render/renderer.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "picture.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

RendererSettings small(int width = 160, int height = 90) {
  RendererSettings settings;
  settings.width = width;
  settings.height = height;
  settings.detail.shadow_size = 512;
  return settings;
}

const Look red{Vector3f(0.9f, 0.05f, 0.05f), 1.0f, 0.8f, false};

TEST(RendererRefusals, NameTheSize) {
  const auto refuses = [](const RendererSettings& settings, const char* found) {
    EXPECT_THAT([&] { Renderer renderer(settings); }, ThrowsMessage<std::invalid_argument>(HasSubstr(found)));
  };
  refuses(small(0, 90), "0 x 90");
  refuses(small(160, -1), "160 x -1");
  refuses(small(1000000, 90), "1000000 x 90");
  RendererSettings settings = small();
  settings.detail.antialiasing.samples = 0;
  refuses(settings, "samples");
  settings = small();
  settings.detail.shadow_size = -1;
  refuses(settings, "shadow map");
  settings.detail.shadow_size = 1 << 20;
  refuses(settings, "shadow map");
}

TEST(RendererRefusals, NameWhatIsBroken) {
  Renderer renderer(small());
  const auto refuses = [&](const FrameContent& frame, const char* found) {
    EXPECT_THAT([&] { renderer.draw(frame); }, ThrowsMessage<std::invalid_argument>(HasSubstr(found)));
  };
  Shape shape = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  FrameContent frame = from_above(9.0);
  frame.meshes = {shape.drawn(red)};
  shape.triangles[0][1] = 4;
  refuses(frame, "point 4 of 4");
  shape.triangles[0][1] = 1;
  shape.points[2].y() = std::numeric_limits<double>::quiet_NaN();
  refuses(frame, "point 2 is not finite");
  shape.points[2].y() = 1.0;
  frame.meshes[0].normals = {};
  refuses(frame, "4 points with 0 normals");
  frame.meshes = {shape.drawn(red)};
  frame.meshes[0].look.opacity = 1.5f;
  refuses(frame, "opacity (1.5)");
  frame.meshes = {shape.drawn(red)};
  frame.light.direction = {0, 0, 0};
  refuses(frame, "light's direction");
  frame = from_above(9.0);
  const std::vector<Vector3d> centers = {{0, 0, 0}};
  frame.spheres = {{centers, 0.0, red}};
  refuses(frame, "radius");
  frame = from_above(9.0);
  frame.camera.eye = frame.camera.target;
  refuses(frame, "eye and target");
}

}  // namespace
}  // namespace deforma
