#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "pipeline/build.hpp"
#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "pipeline/thread_count.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

namespace fs = std::filesystem;

constexpr int frames = 3;
constexpr int thread_counts[] = {1, 2, 8};

/// Scenes beside the shipped ones, by name, that between them call for every effect and both fits, touch from the start,
/// and have enough particles for their loops to be shared out.
const std::map<std::string, std::string> made_scenes = {
    {"pile_linear", R"(
duration = 0.1
[output]
view = "both"
[solver]
gradient = "linear"
[world]
gravity = [0, 0, -9.81]
[[body]]
name = "lower"
shape = { type = "box", size = [0.5, 0.5, 0.4], resolution = 8 }
position = [0, 0, 0.199]
particles = 1500
sampling = "blue_noise"
elastic = { young = 2e4 }
contact = true
[[body]]
name = "upper"
shape = { type = "torus", radius = 0.2, tube_radius = 0.08 }
position = [0.05, 0, 0.5]
rotation = [5, 0, 0]
particles = 1200
jitter = 0.2
velocity = [0, 0, -1]
elastic = { young = 3e4, material = "corotated" }
contact = { friction = 0.5, restitution = 0.5 }
[[obstacle]]
shape = { type = "sphere", radius = 0.2 }
position = [[0, [0.5, 0, 0.2]], [0.02, [0.4, 0, 0.2]]]
[ground]
)"},
    {"many_small_bodies",
     [] {
       std::string scene = "duration = 0.1\n[world]\ngravity = [0, 0, -9.81]\n[ground]\n";
       for (int b = 0; b < 12; ++b)
         scene +=
             "[[body]]\nshape = { type = \"sphere\", radius = 0.1, resolution = 6 }\nparticles = 60\n"
             "elastic = { young = 2e4 }\ncontact = true\nposition = [" +
             std::to_string(0.199 * (b % 3)) + ", " + std::to_string(0.199 * (b / 3 % 2)) + ", " +
             std::to_string(0.099 + 0.199 * (b / 6)) + "]\n";
       return scene;
     }()},
    {"self_contact", R"(
duration = 0.1
[[body]]
shape = { type = "torus", radius = 0.3, tube_radius = 0.08 }
particles = 1100
elastic = { young = 2e4 }
damping = { rate = 1, viscosity = 20 }
contact = { self = true, friction = 0.2 }
pin = [ { region = { max = [-0.25, inf, inf] }, move = [[0, [0, 0, 0]], [0.02, [0.05, 0, 0]]] },
        { region = { min = [0.25, -inf, -inf] }, move = [[0, [0, 0, 0]], [0.02, [-0.05, 0, 0]]] } ]
)"},
    {"lennard_jones", R"(
duration = 0.1
[solver]
gradient = "linear"
[[body]]
shape = { type = "box", size = [0.4, 0.4, 0.4], resolution = 6 }
particles = 1200
elastic = { young = 2e4 }
lennard_jones = { depth = 1e-3, self = true }
[[body]]
shape = { type = "box", size = [0.4, 0.4, 0.4], resolution = 6 }
position = [0.42, 0.02, 0]
particles = 1100
elastic = { young = 2e4 }
lennard_jones = { depth = 1e-3 }
velocity = [-1, 0, 0]
)"},
    {"pressure", R"(
duration = 0.1
[[body]]
shape = { type = "ellipsoid", radii = [0.3, 0.25, 0.2], resolution = 16 }
particles = 1200
elastic = { young = 2e4, poisson = 0.2, material = "st_venant_kirchhoff" }
volume = { stiffness = 1e4 }
pressure = { value = [[0, 0], [0.02, -1000]] }
angular_velocity = [0, 5, 0]
)"},
    {"twisted_bar", R"(
duration = 0.1
[[body]]
shape = { type = "box", size = [0.8, 0.2, 0.2], resolution = 10 }
particles = 1300
elastic = { young = 2e4 }
load = { force = [0, 0, 20], region = { min = [-0.1, -inf, -inf], max = [0.1, inf, inf] } }
pin = [ { region = { max = [-0.38, inf, inf] } },
        { region = { min = [0.38, -inf, -inf] }, rotation = [[0, [0, 0, 0]], [0.02, [30, 0, 0]]], release = 0.015 } ]
)"},
};

/// The shipped scenes and the made ones.
std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(DEFORMA_SOURCE_DIR) / "assets" / "scenes"))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  for (const auto& [name, text] : made_scenes) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

template <typename T>
void append_bytes(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Everything that the simulation has worked out by the last frame.
std::string state_bytes(const Scene& scene) {
  World world = build(scene);
  for (int frame = 1; frame < frames; ++frame) world.solver->advance(1.0 / scene.fps);
  const State& state = world.solver->state();
  std::vector<Vec3> surface(state.surface.size());
  world.solver->deform(surface);
  std::string bytes;
  append_bytes(bytes, state.particles.rest);
  append_bytes(bytes, state.particles.mass);
  append_bytes(bytes, state.particles.volume);
  append_bytes(bytes, state.particles.displacement);
  append_bytes(bytes, state.particles.velocity);
  append_bytes(bytes, state.F);
  append_bytes(bytes, surface);
  return bytes;
}

/// Every picture that a run leaves.
std::map<std::string, std::string> picture_bytes(const Scene& scene, const fs::path& folder) {
  RunOptions options;
  options.folder = folder;
  options.frames = FrameRange{1, frames};
  RunRecord record = run_scene(scene, options);
  EXPECT_EQ(record.ending, Ending::complete) << record.ending_message;
  std::map<std::string, std::string> bytes;
  for (const auto& entry : fs::directory_iterator(folder / "frames"))
    bytes[entry.path().filename()] = read_text_file(entry.path());
  return bytes;
}

class Determinism : public testing::TestWithParam<std::string> {};

TEST_P(Determinism, TheSameBytesOnAnyNumberOfThreads) {
  Scratch scratch;
  auto made = made_scenes.find(GetParam());
  const fs::path file =
      made == made_scenes.end() ? find_scene(GetParam()) : scratch.write("scene.toml", made->second);
  const Scene scene = load_scene(
      file, {{"fps", "100", "test"}, {"output.size", "[160, 90]", "test"}, {"output.video", "none", "test"}});
  std::string state;
  std::map<std::string, std::string> pictures;
  for (int threads : thread_counts) {
    std::string its_state = on_threads(threads, [&] { return state_bytes(scene); });
    auto its_pictures =
        on_threads(threads, [&] { return picture_bytes(scene, scratch / std::to_string(threads)); });
    ASSERT_EQ(its_pictures.size(), std::size_t{frames});
    if (threads == thread_counts[0]) {
      state = std::move(its_state);
      pictures = std::move(its_pictures);
      continue;
    }
    EXPECT_TRUE(its_state == state) << "state on " << threads << " threads";
    for (const auto& [name, bytes] : pictures)
      EXPECT_TRUE(its_pictures[name] == bytes) << name << " on " << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(All, Determinism, testing::ValuesIn(scene_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace deforma
