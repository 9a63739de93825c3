#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pipeline/build.hpp"
#include "tests/pipeline/program.hpp"
#include "tests/pipeline/scratch.hpp"

namespace deforma {

/// Runs a scene by the program, which must refuse it as a user's mistake should be: exit code 2, one line that begins
/// with "error: " and holds every part, and no trace of an output folder.
inline void expect_run_refused(const Scratch& scratch, const std::string& scene,
                               const std::vector<std::string>& parts, const std::string& options = "") {
  const auto file = scratch.write("scene.toml", scene);
  Said said =
      deforma_program("run " + file.string() + " -o " + (scratch / "deep/out").string() + " " + options);
  EXPECT_EQ(said.code, 2) << said.text << scene;
  EXPECT_THAT(said.text, testing::StartsWith("error: ")) << scene;
  EXPECT_EQ(std::count(said.text.begin(), said.text.end(), '\n'), 1) << said.text;
  for (const std::string& part : parts) EXPECT_THAT(said.text, testing::HasSubstr(part)) << scene;
  EXPECT_FALSE(std::filesystem::exists(scratch / "deep")) << scene;
}

inline World build_text(const Scratch& scratch, const std::string& text) {
  return build(load_scene(scratch.write("scene.toml", text)));
}

/// A scene of one body of a mesh file; `body` goes into the body's table, `solver` before it.
inline std::string mesh_scene(const std::string& mesh, const std::string& body,
                              const std::string& solver = "") {
  return "duration = 0.2\nfps = 10\n[output]\nsize = [64, 48]\nvideo = \"none\"\n[solver]\n" + solver +
         "\n[[body]]\nmesh = \"" + mesh + "\"\n" + body + "\n";
}

/// Both ways to find gradients, each with its own hourglass control.
inline const std::vector<std::string> both_gradients = {"gradient = \"linear\"\n",
                                                        "gradient = \"quadratic\"\n"};

inline bool all_finite(const State& state) {
  auto finite = [](const auto& field) {
    return std::all_of(field.begin(), field.end(), [](const auto& entry) { return entry.allFinite(); });
  };
  auto numbers_finite = [](const std::vector<double>& field) {
    return std::all_of(field.begin(), field.end(), [](double x) { return std::isfinite(x); });
  };
  return finite(state.particles.rest) && finite(state.particles.displacement) &&
         finite(state.particles.velocity) && finite(state.F) && finite(state.fit.inverse) &&
         numbers_finite(state.particles.mass) && numbers_finite(state.particles.volume) &&
         numbers_finite(state.links.support);
}

}  // namespace deforma
