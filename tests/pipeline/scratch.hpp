#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "pipeline/scene.hpp"

namespace deforma {

/// A folder of the running test's own, removed at its end.
class Scratch {
 public:
  Scratch() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("deforma_") + test->test_suite_name() + "_" + test->name();
    for (char& c : name)
      if (c == '/') c = '_';
    folder_ = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& path() const { return folder_; }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

 private:
  std::filesystem::path folder_;
};

inline std::string read_text_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// A small scene: a box falls on the ground. `body` is appended to the body's table, `more` to the end.
inline std::string small_scene(const std::string& body = "", const std::string& more = "") {
  return "duration = 0.4\n"
         "fps = 25\n"
         "[output]\n"
         "size = [320, 240]\n"
         "[world]\n"
         "gravity = [0, 0, -9.81]\n"
         "[[body]]\n"
         "shape = { type = \"box\", size = [0.4, 0.4, 0.4], resolution = 4 }\n"
         "position = [0, 0, 0.5]\n"
         "particles = 64\n"
         "contact = true\n" +
         (body.find("elastic") == body.npos ? std::string("elastic = { young = 1e5, poisson = 0.3 }\n")
                                            : "") +
         body + "\n[ground]\n" + more;
}

}  // namespace deforma
