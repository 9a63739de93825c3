#include <fmt/core.h>

#include "pipeline/user_error.hpp"
#include "render/image.hpp"
#include "render/video.hpp"
#include "tests/hard/refusal.hpp"

namespace deforma {
namespace {

using testing::HasSubstr;

/// A scene of one box of 64 particles; `top`, `solver`, `body` and `end` go where their names say.
struct BoxScene {
  std::string top = "duration = 0.4\nfps = 25\n";
  std::string output = "size = [320, 240]\n";
  std::string solver = "";
  std::string body = "particles = 64\ndensity = 1000\nelastic = { young = 1e5, poisson = 0.3 }\n";
  std::string end = "";

  std::string text() const {
    return top + "[output]\n" + output + "[solver]\n" + solver +
           "[[body]]\nshape = { type = \"box\", size = [0.4, 0.4, 0.4], resolution = 4 }\n"
           "position = [0, 0, 0.5]\n" +
           body + end;
  }
};

void expect_refused(const Scratch& scratch, const BoxScene& scene, const std::vector<std::string>& parts) {
  expect_run_refused(scratch, scene.text(), parts);
}

TEST(HardCase, Row12MaterialsOutsideTheirIntervals) {
  Scratch scratch;
  auto elastic = [&](const std::string& key, const std::string& value, const std::string& interval) {
    std::string other = key == "young" ? "poisson = 0.3" : "young = 1e5";
    for (const std::string& written : {value, "[[0, " + value + "]]", "[[0, 0.25], [1, " + value + "]]"}) {
      BoxScene scene;
      scene.body = "particles = 64\nelastic = { " + other + ", " + key + " = " + written + " }\n";
      expect_refused(scratch, scene,
                     {"scene.toml:10: body.elastic." + key + ": " + value + " is outside " + interval});
    }
  };
  for (std::string poisson : {"0.5", "-1", "0.6", "nan", "-inf", "inf", "-1.0000001"})
    elastic("poisson", poisson, "(-1, 0.5)");
  for (std::string young : {"0", "-0.001", "-1000000", "nan", "-inf"}) elastic("young", young, "(0, inf)");
  for (std::string density : {"0", "-1000", "nan", "-inf"}) {
    BoxScene scene;
    scene.body = "particles = 64\ndensity = " + density + "\n";
    expect_refused(scratch, scene, {"scene.toml:10: body.density: " + density + " is outside (0, inf)"});
  }
  // Values just inside are taken.
  for (std::string poisson : {"0.499999", "-0.999999"}) {
    BoxScene scene;
    scene.body = "particles = 64\nelastic = { young = 1e-3, poisson = " + poisson + " }\n";
    EXPECT_NO_THROW(build_text(scratch, scene.text()));
  }
}

TEST(HardCase, Row34NeighborsAndSupport) {
  Scratch scratch;
  for (std::string gradient : {"linear", "quadratic"}) {
    const std::string solver = "gradient = \"" + gradient + "\"\n";
    for (std::string few : {"2", "1", "0", "-3"}) {
      BoxScene scene;
      scene.solver = solver + "neighbors = " + few + "\n";
      expect_refused(scratch, scene, {"scene.toml:7: solver.neighbors: " + few + " is outside [3, "});
    }
    // k > N - 1: refused when it was asked for, clipped when not.
    for (int particles : {1, 2, 3, 8, 64}) {
      BoxScene scene;
      scene.body = fmt::format("particles = {}\nelastic = {{ young = 1e5 }}\n", particles);
      scene.solver = solver;
      World world = build_text(scratch, scene.text());
      world.solver->advance(0.01);
      EXPECT_TRUE(all_finite(world.solver->state()));
      scene.solver = solver + fmt::format("neighbors = {}\n", std::max(3, particles));
      std::string allowed =
          particles > 3 ? fmt::format("expected 3 to {}", particles - 1) : "too few for any number";
      expect_refused(scratch, scene,
                     {fmt::format("solver.neighbors: found {}", std::max(3, particles)),
                      fmt::format("a particle of 'box' has {} others", particles - 1), allowed});
      if (particles < 4) continue;
      scene.solver = solver + fmt::format("neighbors = {}\n", particles - 1);
      EXPECT_NO_THROW(build_text(scratch, scene.text()));
    }
    // So narrow that some reach no other particle: each count is what a lattice of 4 x 4 x 4 gives.
    std::vector<std::pair<std::string, int>> narrow = {{"0.5", 32}};
    if (gradient == "linear") narrow = {{"0.5", 64}, {"0.7", 8}};
    for (const auto& [support, lonely] : narrow) {
      BoxScene scene;
      scene.solver = solver + "support = " + support + "\n";
      std::string message;
      try {
        build_text(scratch, scene.text());
      } catch (const std::exception& error) {
        message = error.what();
      }
      expect_refused(
          scratch, scene,
          {fmt::format("solver.support: {} leaves {} of the 64 particles of 'box' without a neighbour",
                       support, lonely),
           "expected above "});
      // What it says suffices does suffice.
      double needed = std::stod(message.substr(message.find("expected above ") + 15));
      scene.solver = solver + fmt::format("support = {}\n", 1.01 * needed);
      EXPECT_NO_THROW(build_text(scratch, scene.text())) << message;
    }
    for (std::string support : {"0", "-1", "nan", "inf", "5.1"}) {
      BoxScene scene;
      scene.solver = solver + "support = " + support + "\n";
      expect_refused(scratch, scene, {"scene.toml:7: solver.support: " + support + " is outside [0.5, 5]"});
    }
  }
}

TEST(HardCase, Row34KernelsThatDoNotExist) {
  Scratch scratch;
  for (std::string kernel : {"0", "6", "-1", "1.5", "nan"}) {
    BoxScene scene;
    scene.solver = "kernel = " + kernel + "\n";
    expect_refused(scratch, scene,
                   {"scene.toml:6: solver.kernel: expected a text in quotes, found " + kernel,
                    "(allowed: poly6, gaussian, cubic_spline, quartic, wide_cubic_spline)"});
  }
  for (std::string kernel : {"W0", "W6", "", "cubic"}) {
    BoxScene scene;
    scene.solver = "kernel = \"" + kernel + "\"\n";
    expect_refused(scratch, scene,
                   {"scene.toml:6: solver.kernel: unknown choice '" + kernel + "'",
                    "(allowed: poly6, gaussian, cubic_spline, quartic, wide_cubic_spline)"});
  }
}

TEST(HardCase, Row34StepsDurationsAndRates) {
  Scratch scratch;
  for (std::string step : {"-1e-05", "-1", "nan", "-inf"}) {
    BoxScene scene;
    scene.solver = "max_step = " + step + "\n";
    expect_refused(scratch, scene, {"scene.toml:6: solver.max_step: " + step + " is outside [0, inf)"});
  }
  for (std::string fraction : {"-0.5", "0", "1.1", "nan"}) {
    BoxScene scene;
    scene.solver = "step_fraction = " + fraction + "\n";
    expect_refused(scratch, scene,
                   {"scene.toml:6: solver.step_fraction: " + fraction + " is outside (0, 1]"});
  }
  for (std::string fps : {"0", "-25", "nan", "inf", "1001"}) {
    BoxScene scene;
    scene.top = "duration = 0.4\nfps = " + fps + "\n";
    expect_refused(scratch, scene, {"scene.toml:2: fps: " + fps + " is outside (0, 1000]"});
  }
  for (std::string duration : {"0", "-1", "nan"}) {
    BoxScene scene;
    scene.top = "duration = " + duration + "\n";
    expect_refused(scratch, scene, {"scene.toml:1: duration: " + duration + " is outside (0, inf)"});
  }
  BoxScene endless;
  endless.top = "duration = inf\n";
  expect_refused(scratch, endless, {"scene.toml:1: duration: inf is not finite"});
}

TEST(HardCase, Row34SizesOfPictures) {
  Scratch scratch;
  for (std::string size : {"[0, 240]", "[320, 0]", "[-1, 240]", "[320, 16385]"}) {
    BoxScene scene;
    scene.output = "size = " + size + "\n";
    expect_refused(scratch, scene, {"scene.toml:4: output.size: ", " pixels is outside [1, 16384]"});
  }
  for (std::string size : {"[nan, 240]", "[320.5, 240]", "[320]", "320"}) {
    BoxScene scene;
    scene.output = "size = " + size + "\n";
    expect_refused(scratch, scene,
                   {"scene.toml:4: output.size: expected two whole numbers [width, height], found " + size});
  }
  expect_run_refused(scratch, BoxScene{}.text(), {"--size 0x9: output.size: 0 pixels is outside [1, 16384]"},
                     "--size 0x9");
  // Odd sizes: the pictures as asked, the video one column and row larger, as yuv420 needs.
  BoxScene odd;
  odd.output = "size = [161, 97]\n";
  const auto out = scratch / "odd";
  Said said =
      deforma_program("run " + scratch.write("odd.toml", odd.text()).string() + " -o " + out.string());
  ASSERT_EQ(said.code, 0) << said.text;
  Image image = read_png(out / "frames/0001.png");
  EXPECT_EQ(image.width, 161);
  EXPECT_EQ(image.height, 97);
  VideoFacts video = inspect_video(out / "video.mp4");
  EXPECT_EQ(video.width, 162);
  EXPECT_EQ(video.height, 98);
  EXPECT_EQ(video.frames, 10u);
  EXPECT_EQ(video.pixel_format, "yuv420p");
}

TEST(HardCase, Row34NanAnywhere) {
  Scratch scratch;
  const std::string box =
      "shape = { type = \"box\", size = [0.4, 0.4, 0.4], resolution = 4 }\nparticles = 64\n";
  // Every key that takes a number, and where it stands.
  const std::vector<std::pair<std::string, std::string>> top_tables = {
      {"output", "crf samples"},
      {"solver", "step_fraction max_step neighbors support"},
      {"camera", "field_of_view height orbit position* target* up*"},
      {"light", "intensity ambient exposure direction*"},
      {"ground", "height friction color*"}};
  std::vector<std::pair<std::string, std::string>> scenes;  // key, text
  auto add_all = [&](const std::string& head, const std::string& keys, const std::string& before,
                     const std::string& after) {
    std::istringstream list(keys);
    for (std::string key; list >> key;) {
      bool vector = key.back() == '*';
      if (vector) key.pop_back();
      scenes.emplace_back(head + key, before + key + " = " + (vector ? "[0, nan, 1]" : "nan") + "\n" + after);
    }
  };
  add_all("", "duration", "", "[[body]]\n" + box);
  add_all("", "fps", "duration = 1\n", "[[body]]\n" + box);
  for (const auto& [table, keys] : top_tables)
    add_all(table + ".", keys, "duration = 1\n[" + table + "]\n", "[[body]]\n" + box);
  add_all("body.", "density position* rotation* velocity* angular_velocity* scale* scale subdivide",
          "duration = 1\n[[body]]\n" + box, "");
  add_all("body.", "particles spacing surface_particles",
          "duration = 1\n[[body]]\nshape = { type = \"box\", size = [1, 1, 1] }\n", "");
  add_all("body.look.", "opacity roughness metallic color*",
          "duration = 1\n[[body]]\n" + box + "[body.look]\n", "");
  add_all("obstacle.", "position* rotation* friction",
          "duration = 1\n[[body]]\n" + box + "[[obstacle]]\nshape = { type = \"sphere\", radius = 0.1 }\n",
          "");
  add_all("obstacle.shape.", "radius",
          "duration = 1\n[[body]]\n" + box + "[[obstacle]]\n[obstacle.shape]\ntype = \"sphere\"\n", "");
  add_all("body.shape.", "radius resolution",
          "duration = 1\n[[body]]\nparticles = 9\n[body.shape]\ntype = \"sphere\"\n", "");
  std::size_t of_effects = 0;
  for (const EffectInfo& info : effect_registry())
    for (const Setting& setting : info.settings) {
      std::string value = std::holds_alternative<Curve<double>>(setting.fallback) ? "nan"
                          : std::holds_alternative<Curve<Vec3>>(setting.fallback) ? "[0, nan, 1]"
                          : std::holds_alternative<Region>(setting.fallback)      ? "{ min = [0, nan, 1] }"
                                                                                  : "";
      if (value.empty()) continue;
      ++of_effects;
      scenes.emplace_back(
          fmt::format("body.{}.{}", info.name, setting.key),
          fmt::format("duration = 1\n[[body]]\n{}{} = {{ {} = {} }}\n", box, info.name, setting.key, value));
    }
  EXPECT_GT(of_effects, 15u);
  EXPECT_GT(scenes.size(), 50u);
  for (const auto& [key, text] : scenes) {
    try {
      load_scene(scratch.write("scene.toml", text));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr(": " + key)) << text;
      EXPECT_THAT(error.what(), HasSubstr("nan")) << text;
    }
  }
  // And all the way, by the program.
  BoxScene scene;
  scene.body += "velocity = [0, nan, 0]\n";
  expect_refused(scratch, scene, {"scene.toml:12: body.velocity: nan is outside "});
  expect_run_refused(scratch, BoxScene{}.text(),
                     {"--set world.gravity=[0,0,nan]: world.gravity", "nan is outside "},
                     "--set 'world.gravity=[0,0,nan]'");
}

TEST(HardCase, Row36NoParticlesOrMoreThanTheMemoryHolds) {
  Scratch scratch;
  auto refused = [&](const std::string& amount, const std::vector<std::string>& parts) {
    for (std::string sampling : {"lattice", "body_centered", "blue_noise"}) {
      BoxScene scene;
      scene.body = amount + "\nsampling = \"" + sampling + "\"\n";
      expect_refused(scratch, scene, parts);
    }
  };
  refused("particles = 0", {"scene.toml:9: body.particles: 0 is outside [1, 2000000000]"});
  refused("particles = -5", {"scene.toml:9: body.particles: -5 is outside [1, 2000000000]"});
  refused("particles = 3000000000", {"body.particles: 3000000000 is outside [1, 2000000000]"});
  refused("particles = 1000000000", {"scene.toml:6: body: particles: 1e+09 particles need about ",
                                     " GiB of memory, this machine has "});
  refused("spacing = 0", {"scene.toml:9: body.spacing: 0 is outside (0, inf)"});
  refused("spacing = -0.1", {"scene.toml:9: body.spacing: -0.1 is outside (0, inf)"});
  refused("spacing = nan", {"scene.toml:9: body.spacing: nan is outside (0, inf)"});
  refused("spacing = inf", {"scene.toml:9: body.spacing: inf is not finite"});
  refused("spacing = 0.0001", {"scene.toml:6: body: spacing: 0.0001 m: 6.4e+10 particles need about "});
  for (std::string spacing : {"1e-30", "1e-300"})
    refused("spacing = " + spacing,
            {"body: spacing: " + spacing + " m: ", "GiB of memory, this machine has "});
  for (std::string spacing : {"5", "1e+30", "1e+300"})
    refused("spacing = " + spacing, {"body: spacing: " + spacing + " m leaves ",
                                     " particles in the mesh, expected at least 4: use at most 0."});
  // The memory is that of the fit which was asked for: about 0.9 kB a particle for the linear one, several times as
  // much for the quadratic one.
  std::vector<double> needed;
  for (const std::string& solver : both_gradients) {
    BoxScene scene;
    scene.solver = solver;
    scene.body = "particles = 1000000000\n";
    try {
      build_text(scratch, scene.text());
      ADD_FAILURE() << "accepted";
    } catch (const UserError& error) {
      const std::string message = error.what();
      needed.push_back(std::stod(message.substr(message.find("need about ") + 11)));
    }
  }
  ASSERT_EQ(needed.size(), 2u);
  EXPECT_GT(needed[0], 0.8e12 / 0x1p30);
  EXPECT_LT(needed[0], 1.2e12 / 0x1p30);
  EXPECT_GT(needed[1], 3.0 * needed[0]);
  // Counts that are small are given all the same.
  for (int particles : {1, 2, 3, 4}) {
    BoxScene scene;
    scene.body = fmt::format("particles = {}\n", particles);
    EXPECT_EQ(build_text(scratch, scene.text()).bodies[0].particles, static_cast<std::size_t>(particles));
  }
}

}  // namespace
}  // namespace deforma
