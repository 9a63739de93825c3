#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cstdlib>

#include "picture.hpp"

namespace deforma {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

RendererSettings small(int width = 160, int height = 90) {
  RendererSettings settings;
  settings.width = width;
  settings.height = height;
  settings.detail.shadow_size = 512;
  return settings;
}

bool is_red(const Image& image, int x, int y) {
  const auto p = pixel(image, x, y);
  return p[0] > p[1] + 60 && p[0] > p[2] + 60;
}

const Look red{Vector3f(0.9f, 0.05f, 0.05f), 1.0f, 0.8f, false};
const Look blue{Vector3f(0.05f, 0.1f, 0.9f), 1.0f, 0.8f, false};

TEST(Renderer, DrawsWithoutADisplay) {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"}) unsetenv(name);
  Renderer renderer(small());
  const Image image = renderer.draw(from_above(9.0));
  EXPECT_EQ(image.width, 160);
  EXPECT_EQ(image.height, 90);
  EXPECT_EQ(image.rgba.size(), 4u * 160u * 90u);
  EXPECT_FALSE(renderer.facts().renderer.empty());
}

TEST(Renderer, ShowsTheBackgroundAsItWasGiven) {
  FrameContent frame = from_above(9.0);
  frame.background = {0.30f, 0.60f, 0.90f};
  const auto p = pixel(Renderer(small()).draw(frame), 80, 40);
  EXPECT_NEAR(p[0], 0.30 * 255, 2);
  EXPECT_NEAR(p[1], 0.60 * 255, 2);
  EXPECT_NEAR(p[2], 0.90 * 255, 2);
  EXPECT_EQ(p[3], 255);
}

/// A picture with straight alpha laid over an even sRGB colour, in linear light.
std::array<int, 4> over(const std::array<int, 4>& p, const Vector3f& below) {
  std::array<int, 4> result = {0, 0, 0, 255};
  const double alpha = p[3] / 255.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double behind = to_linear(static_cast<double>(below[static_cast<int>(c)]));
    result[c] =
        static_cast<int>(std::lround(to_srgb(alpha * to_linear(p[c] / 255.0) + (1.0 - alpha) * behind)));
  }
  return result;
}

TEST(Renderer, TransparentPicturesLieOverAnyBackgroundWithoutFringe) {
  const Shape sphere = ball({0.0, 0.0, 0.0}, 2.5, 24);
  const DrawnGround ground{-3.0, {0.8f, 0.8f, 0.8f}};
  FrameContent frame = from_above(9.0);
  frame.meshes = {sphere.drawn(red)};
  frame.ground = &ground;
  frame.transparent = true;
  Renderer renderer(small());
  const Image image = renderer.draw(frame);
  EXPECT_EQ(pixel(image, 80, 45)[3], 255);
  EXPECT_EQ(pixel(image, 5, 5)[3], 0) << "neither floor nor backdrop";
  int edges = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 160; ++x) {
      const auto p = pixel(image, x, y);
      if (p[3] == 0 || p[3] == 255) continue;
      ++edges;
      EXPECT_GT(p[0], p[1] + 25) << x << ' ' << y
                                 << ": an edge has the colour of the body, not of what is behind";
    }
  EXPECT_GT(edges, 60);
  // The same as if drawn before a background, but for the floor, which is not seen here, and the dither.
  frame.ground = nullptr;
  const Image alone = renderer.draw(frame);
  frame.transparent = false;
  const Image before = renderer.draw(frame);
  for (int x = 50; x < 110; ++x) {
    const auto p = pixel(alone, x, 45);
    if (p[3] != 255) continue;
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(p[c], pixel(before, x, 45)[c], 1) << x;
  }
}

TEST(Renderer, TransparentGlassLetsTheBackgroundThrough) {
  const Shape pane = rectangle({0.0, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
  FrameContent frame = from_above(9.0);
  const Look glass{Vector3f(0.8f, 0.8f, 0.8f), 0.3f, 0.8f, false};
  frame.meshes = {pane.drawn(glass)};
  frame.background = {0.5f, 0.5f, 0.5f};
  Renderer renderer(small());
  const Image before = renderer.draw(frame);
  EXPECT_EQ(pixel(before, 80, 45)[3], 255) << "opaque pictures stay opaque behind glass";
  frame.transparent = true;
  const auto p = pixel(renderer.draw(frame), 80, 45);
  EXPECT_GT(p[3], 30);
  EXPECT_LT(p[3], 225);
  const auto shown = over(p, {0.5f, 0.5f, 0.5f});
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], pixel(before, 80, 45)[c], 6);
}

TEST(Renderer, CoversThePixelsOfATriangle) {
  // 9 m over 90 rows: 10 pixels a metre, the origin between pixels 79|80 and 44|45.
  Shape shape;
  shape.points = {{-3.0, -2.0, 0.0}, {3.0, -2.0, 0.0}, {-3.0, 2.0, 0.0}};
  shape.normals.assign(3, Vector3d::UnitZ());
  shape.triangles = {{0, 1, 2}};
  FrameContent frame = from_above(9.0);
  frame.meshes = {shape.drawn(red)};
  const Image image = Renderer(small()).draw(frame);
  int covered = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 160; ++x) covered += is_red(image, x, y);
  EXPECT_NEAR(covered, 0.5 * 60 * 40, 40);
  EXPECT_TRUE(is_red(image, 51, 63)) << "the right angle, lower left";
  EXPECT_TRUE(is_red(image, 51, 29)) << "upper left";
  EXPECT_TRUE(is_red(image, 105, 63)) << "lower right";
  EXPECT_FALSE(is_red(image, 105, 29));
  EXPECT_FALSE(is_red(image, 48, 50));
  EXPECT_FALSE(is_red(image, 60, 67));
}

TEST(Renderer, ResolvesEdgesInLinearLight) {
  // An edge through the middle of a column of pixels: half of their light comes from either side.
  FrameContent frame = from_above(9.0);
  frame.background = {0.0f, 0.0f, 0.0f};
  frame.light.intensity = 0.0f;
  frame.light.ambient = 0.7f;
  const Shape sheet = rectangle({3.05, 0.0, 0.0}, {3.0, 0.0, 0.0}, {0.0, 3.0, 0.0});
  frame.meshes = {sheet.drawn({Vector3f(1.0f, 1.0f, 1.0f), 1.0f, 1.0f, false})};
  RendererSettings settings = small();
  settings.detail.shadow_size = 0;
  const Image image = Renderer(settings).draw(frame);
  const double full = pixel(image, 90, 45)[0], half = pixel(image, 80, 45)[0];
  EXPECT_GT(full, 200.0);
  EXPECT_EQ(pixel(image, 79, 45)[0], 0);
  EXPECT_NEAR(half, to_srgb(0.5 * to_linear(full / 255.0)), 3.0);
}

TEST(Renderer, ToneMapsAFlatColourAsPublished) {
  // Only the even sky, on a sheet that faces it, seen along its normal: albedo (1 - m) + m * mirrored sky, m = 0.04, with
  // the mirrored sky 0.75 + 0.35 times the sky, then the tone map: less its smallest channel's share of the reflection.
  FrameContent frame = from_above(9.0);
  frame.light.intensity = 0.0f;
  frame.light.ambient = 0.5f;
  const Shape sheet = rectangle({0, 0, 0}, {3, 0, 0}, {0, 3, 0});
  const Vector3f color(0.9f, 0.6f, 0.4f);
  frame.meshes = {sheet.drawn({color, 1.0f, 1.0f, false})};
  RendererSettings settings = small();
  settings.detail.shadow_size = 0;
  const auto p = pixel(Renderer(settings).draw(frame), 80, 45);
  Vector3d radiance;
  for (int i = 0; i < 3; ++i) radiance[i] = 0.5 * (0.96 * to_linear(color[i]) + 0.04 * (0.75 + 0.35));
  const double least = radiance.minCoeff();
  const double offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(p[i], to_srgb(radiance[static_cast<Eigen::Index>(i)] - offset), 2.0) << "channel " << i;
}

TEST(Renderer, HidesTheFartherBehindTheNearer) {
  const Shape near = rectangle({0, 0, 1}, {1, 0, 0}, {0, 1, 0}),
              far = rectangle({0, 0, -1}, {3, 0, 0}, {0, 3, 0});
  FrameContent frame = from_above(9.0);
  Renderer renderer(small());
  frame.meshes = {near.drawn(red), far.drawn(blue)};
  const Image one = renderer.draw(frame);
  frame.meshes = {far.drawn(blue), near.drawn(red)};
  const Image other = renderer.draw(frame);
  EXPECT_TRUE(is_red(one, 80, 45));
  EXPECT_FALSE(is_red(one, 60, 45));
  EXPECT_EQ(one.rgba, other.rgba) << "whatever the order";
}

TEST(Renderer, LightsBothSidesOfAnOpenMesh) {
  FrameContent frame = from_above(9.0);
  frame.light.direction = {0, 0, -1};
  Renderer renderer(small());
  const Shape front = rectangle({0, 0, 0}, {2, 0, 0}, {0, 2, 0}),
              back = rectangle({0, 0, 0}, {0, 2, 0}, {2, 0, 0});
  frame.meshes = {front.drawn(red)};
  const Image seen_from_front = renderer.draw(frame);
  frame.meshes = {back.drawn(red)};
  EXPECT_LE(largest_difference(seen_from_front, renderer.draw(frame)), 1);
}

TEST(Renderer, FlatLookNeedsNoNormals) {
  Shape shape = ball({0, 0, 0}, 2.0, 4);
  shape.normals.clear();
  FrameContent frame = from_above(9.0);
  Look look = red;
  look.flat = true;
  frame.meshes = {shape.drawn(look)};
  const Image image = Renderer(small()).draw(frame);
  // Two facets that meet at the pole, each even in itself.
  EXPECT_NEAR(brightness(image, 86, 42), brightness(image, 88, 43), 6);
  EXPECT_GT(std::abs(brightness(image, 88, 43) - brightness(image, 72, 47)), 12);
}

TEST(Renderer, ThrowsAShadowOnTheGround) {
  FrameContent frame = from_above(9.0, 30.0);
  const DrawnGround ground{-1.5, Vector3f(0.7f, 0.7f, 0.7f)};
  frame.ground = &ground;
  frame.light.direction = {1.0, 0.0, -1.0};
  const Shape body = ball({-1, 0, 0.5}, 0.7, 24);
  Renderer renderer(small());
  frame.meshes = {body.drawn(red)};
  const Image meshed = renderer.draw(frame);
  // The light runs 2 m down and so 2 m to the right: the shadow's middle is at x = 1, picture x = 90.
  RendererSettings without = small();
  without.detail.shadow_size = 0;
  const int lit = brightness(Renderer(without).draw(frame), 90, 45), dark = brightness(meshed, 90, 45);
  EXPECT_LT(dark, 0.8 * lit);
  EXPECT_GT(dark, 0.2 * lit) << "the sky still lights it";

  const std::vector<Vector3d> centers = {{-1, 0, 0.5}};
  frame.meshes.clear();
  frame.spheres = {{centers, 0.7, red}};
  EXPECT_NEAR(brightness(renderer.draw(frame), 90, 45), dark, 20) << "a sphere throws the same";
}

TEST(Renderer, ThrowsAShadowOnOtherBodiesAndNoneOnItself) {
  FrameContent frame = from_above(9.0, 30.0);
  frame.light.direction = {1.0, 0.0, -1.0};
  const Shape sheet = rectangle({0, 0, -1}, {6, 0, 0}, {0, 4, 0}), body = ball({-2, 0, 1}, 0.7, 24);
  const Look white{Vector3f(0.8f, 0.8f, 0.8f), 1.0f, 1.0f, false};
  Renderer renderer(small());
  frame.meshes = {sheet.drawn(white)};
  const Image alone = renderer.draw(frame);
  frame.meshes = {sheet.drawn(white), body.drawn(red)};
  const Image both = renderer.draw(frame);
  EXPECT_LT(brightness(both, 80, 45), 0.8 * brightness(alone, 80, 45));
  EXPECT_NEAR(brightness(both, 130, 20), brightness(alone, 130, 20), 6);
  // No spots anywhere: the sheet under even light stays even, to the dither.
  for (int y = 10; y < 80; ++y)
    for (int x = 30; x < 130; ++x)
      ASSERT_NEAR(brightness(alone, x, y), brightness(alone, 80, 45), 12) << x << " " << y;
}

TEST(Renderer, MixesWhatIsTranslucentWithWhatIsBehind) {
  FrameContent frame = from_above(9.0);
  const Shape pane = rectangle({0, 0, 1}, {2, 0, 0}, {0, 2, 0}),
              wall = rectangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  Renderer renderer(small());
  frame.meshes = {wall.drawn(red)};
  const int bare = pixel(renderer.draw(frame), 80, 45)[2];
  Look glass = blue;
  glass.opacity = 0.5f;
  for (const bool pane_first : {true, false}) {
    frame.meshes = {pane.drawn(glass), wall.drawn(red)};
    if (!pane_first) std::swap(frame.meshes[0], frame.meshes[1]);
    const auto p = pixel(renderer.draw(frame), 80, 45);
    EXPECT_GT(p[0], 60) << "the red wall shows through";
    EXPECT_GT(p[2], bare + 30) << "the blue pane is seen";
  }
}

TEST(Renderer, DrawsTheFarSideOfGlassFirst) {
  // A container whose triangles face inwards looks as one whose triangles face outwards.
  const Shape outwards = ball({0, 0, 0}, 2.0, 24);
  Shape inwards = outwards;
  for (auto& triangle : inwards.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& normal : inwards.normals) normal = -normal;
  FrameContent frame = from_above(9.0);
  Renderer renderer(small());
  Look glass{Vector3f(0.2f, 0.7f, 0.4f), 0.4f, 0.2f, false};
  frame.meshes = {outwards.drawn(glass)};
  const Image one = renderer.draw(frame);
  frame.meshes = {inwards.drawn(glass)};
  EXPECT_LE(largest_difference(one, renderer.draw(frame)), 2);
}

TEST(Renderer, TranslucentBodiesThrowNoShadow) {
  FrameContent frame = from_above(9.0, 30.0);
  const DrawnGround ground{-1.5, Vector3f(0.7f, 0.7f, 0.7f)};
  frame.ground = &ground;
  frame.light.direction = {1.0, 0.0, -1.0};
  const Shape body = ball({-1, 0, 0.5}, 0.7, 24);
  Look glass = blue;
  glass.opacity = 0.3f;
  frame.meshes = {body.drawn(glass)};
  Renderer renderer(small());
  const Image with_body = renderer.draw(frame);
  frame.meshes[0].look.opacity = 1.0f;
  EXPECT_LT(brightness(renderer.draw(frame), 90, 45), 0.8 * brightness(with_body, 90, 45));
}

TEST(Renderer, SpheresHaveTheRightOutline) {
  // A sphere of 2 m at 30 m spans tan(asin(2/30)) * 30 m around the middle; 20 pixels a metre.
  FrameContent frame = from_above(9.0, 30.0);
  frame.background = {0.0f, 0.0f, 0.0f};
  const std::vector<Vector3d> centers = {{0, 0, 0}};
  frame.spheres = {{centers, 2.0, red}};
  const Image image = Renderer(small(320, 180)).draw(frame);
  const double radius = 20.0 * 30.0 * std::tan(std::asin(2.0 / 30.0));
  double width = 0.0, height = 0.0;
  for (int x = 0; x < 320; ++x) width += pixel(image, x, 90)[0] > 40;
  for (int y = 0; y < 180; ++y) height += pixel(image, 160, y)[0] > 40;
  EXPECT_NEAR(width, 2.0 * radius, 2.0);
  EXPECT_NEAR(height, 2.0 * radius, 2.0);
}

TEST(Renderer, SpheresLookLikeMeshes) {
  FrameContent frame = from_above(9.0, 30.0);
  const DrawnGround ground{-2.0, Vector3f(0.7f, 0.7f, 0.7f)};
  frame.ground = &ground;
  const Shape shape = ball({0.5, 0, 0}, 2.0, 96);
  const std::vector<Vector3d> centers = {{0.5, 0, 0}};
  Renderer renderer(small(320, 180));
  frame.meshes = {shape.drawn(red)};
  const Image mesh = renderer.draw(frame);
  frame.meshes.clear();
  frame.spheres = {{centers, 2.0, red}};
  EXPECT_LT(share_of_different(mesh, renderer.draw(frame), 12), 0.02);
}

TEST(Renderer, SpheresHaveDepth) {
  // Two spheres that cut each other, one a little higher: the border is where the surfaces meet, not where quads do.
  FrameContent frame = from_above(9.0, 30.0);
  const std::vector<Vector3d> left = {{-0.5, 0, 0}}, right = {{0.5, 0, 0}};
  frame.spheres = {{left, 2.0, red}, {right, 2.0, blue}};
  Renderer renderer(small(320, 180));
  const Image image = renderer.draw(frame);
  EXPECT_TRUE(is_red(image, 157, 90));
  EXPECT_FALSE(is_red(image, 163, 90));
  std::swap(frame.spheres[0], frame.spheres[1]);
  EXPECT_LT(share_of_different(image, renderer.draw(frame), 2), 0.01);
}

FrameContent scene_at(const Vector3d& place, Shape& body, std::vector<Vector3d>& centers,
                      DrawnGround& ground) {
  body = ball(place, 1.0, 24);
  centers = {place + Vector3d(1.5, 0.5, -0.5), place + Vector3d(-1.6, 0.4, -0.4)};
  ground = {place.z() - 1.0, Vector3f(0.7f, 0.7f, 0.7f)};
  FrameContent frame;
  frame.camera.eye = place + Vector3d(3, -6, 3);
  frame.camera.target = place;
  frame.ground = &ground;
  frame.meshes = {body.drawn(red)};
  frame.spheres = {{centers, 0.5, blue}};
  return frame;
}

TEST(Renderer, FarFromTheOriginLooksTheSame) {
  Shape here_body, there_body;
  std::vector<Vector3d> here_centers, there_centers;
  DrawnGround here_ground, there_ground;
  Renderer renderer(small(320, 180));
  const Image here = renderer.draw(scene_at({0, 0, 0}, here_body, here_centers, here_ground));
  const Image there = renderer.draw(scene_at({1e5, -2e5, 3e5}, there_body, there_centers, there_ground));
  EXPECT_LT(share_of_different(here, there, 2), 0.001);
}

TEST(Renderer, DrawsTheSameBytesTwice) {
  Shape body;
  std::vector<Vector3d> centers;
  DrawnGround ground;
  const FrameContent frame = scene_at({0, 0, 0}, body, centers, ground);
  Renderer renderer(small());
  const Image first = renderer.draw(frame);
  renderer.draw(from_above(3.0));
  EXPECT_EQ(first.rgba, renderer.draw(frame).rgba);
  EXPECT_EQ(first.rgba, Renderer(small()).draw(frame).rgba) << "and by another renderer";
}

TEST(Renderer, ScalesLeaveThePictureAsItIs) {
  Renderer renderer(small());
  Image reference;
  for (const double scale : {1.0, 1e-4, 1e4}) {
    const Shape body = ball({0, 0, scale}, scale, 24);
    const DrawnGround ground{0.0, Vector3f(0.7f, 0.7f, 0.7f)};
    FrameContent frame;
    frame.camera.eye = scale * Vector3d(3, -6, 3);
    frame.ground = &ground;
    frame.meshes = {body.drawn(red)};
    const Image image = renderer.draw(frame);
    if (reference.rgba.empty()) reference = image;
    EXPECT_LT(share_of_different(reference, image, 3), 0.005) << scale;
  }
}

TEST(Renderer, DrawsAnEmptyFrameAndABodyAroundTheCamera) {
  Renderer renderer(small());
  const DrawnGround ground;
  FrameContent frame;
  frame.ground = &ground;
  EXPECT_NO_THROW(renderer.draw(frame));
  const Shape room = ball(frame.camera.eye, 1.0, 8);
  frame.meshes = {room.drawn(red)};
  EXPECT_TRUE(is_red(renderer.draw(frame), 80, 45));
  const Shape nothing;
  frame.meshes = {nothing.drawn(red)};
  EXPECT_NO_THROW(renderer.draw(frame));
}

TEST(Renderer, SharesItsCostOutAmongThePasses) {
  Shape body;
  std::vector<Vector3d> centers;
  DrawnGround ground;
  const FrameContent frame = scene_at({0, 0, 0}, body, centers, ground);
  Renderer renderer(small());
  EXPECT_EQ(renderer.cost().frames, 0);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 3; ++i) renderer.draw(frame);
  const double whole = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const DrawingCost& cost = renderer.cost();
  EXPECT_EQ(cost.frames, 3);
  double sum = 0.0;
  for (const double part : {cost.upload, cost.shadow, cost.shading, cost.resolve, cost.readback}) {
    EXPECT_GE(part, 0.0);
    sum += part;
  }
  EXPECT_GT(cost.shading, 0.0);
  EXPECT_LE(sum, whole);
}

TEST(Renderer, LowersSamplesToWhatThereIs) {
  RendererSettings settings = small();
  settings.detail.antialiasing.samples = 1000;
  EXPECT_NO_THROW(Renderer(settings).draw(from_above(9.0)));
  settings.detail.antialiasing.samples = 1;
  EXPECT_NO_THROW(Renderer(settings).draw(from_above(9.0)));
}

}  // namespace
}  // namespace deforma
