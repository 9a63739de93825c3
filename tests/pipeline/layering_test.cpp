#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

/// Which rooms a room may include; tests may include what the room they mirror may.
const std::map<std::string, std::set<std::string>> allowed = {
    {"sim", {"sim"}},
    {"assets", {"assets"}},
    {"render", {"render"}},
    {"pipeline", {"sim", "assets", "render", "pipeline"}},
};

/// The libraries that every room may include, and those of one room alone; tests add theirs. Headers without a
/// folder or an ending are the standard library's.
const std::set<std::string> common_libraries = {"Eigen", "fmt", "tbb", "unistd.h", "signal.h", "sys"};
const std::set<std::string> test_libraries = {"gtest", "gmock"};
const std::map<std::string, std::set<std::string>> own_libraries = {
    {"sim", {"nanoflann.hpp"}},
    {"assets", {"assimp", "nanoflann.hpp"}},
    {"render",
     {"epoxy", "EGL", "png.h", "cairo.h", "cairo-pdf.h", "cairo-svg.h", "libavcodec", "libavformat",
      "libavutil", "libswscale"}},
    {"pipeline", {"CLI", "nlohmann", "toml++"}},
};

/// Whether a file of a room may include a header, named from the root or in angle brackets.
bool may_include(const std::string& room, const std::string& header, bool test) {
  std::string first = header.substr(0, header.find('/'));
  if (first == "tests") return test;
  if (allowed.count(first)) return allowed.at(room).count(first) > 0;
  bool standard = first == header && header.find('.') == header.npos;
  return standard || common_libraries.count(first) || own_libraries.at(room).count(first) ||
         (test && test_libraries.count(first));
}

/// Every header that a text includes, but for files beside it (in quotes, without a folder).
std::vector<std::string> included_headers(std::istream& text) {
  std::vector<std::string> headers;
  for (std::string line; std::getline(text, line);) {
    line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return c == ' ' || c == '\t'; }),
               line.end());
    if (line.rfind("#include\"", 0) != 0 && line.rfind("#include<", 0) != 0) continue;
    std::string header = line.substr(std::string("#include<").size());
    header.erase(header.find_first_of("\">"));
    bool beside = line.find('"') != line.npos && header.find('/') == header.npos;
    if (!beside) headers.push_back(header);
  }
  return headers;
}

/// "FILE includes HEADER" for each include that crosses the layout.
std::vector<std::string> violations(const fs::path& folder, const std::string& room, bool test = false) {
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream text(entry.path());
    for (const std::string& header : included_headers(text))
      if (!may_include(room, header, test)) found.push_back(entry.path().string() + " includes " + header);
  }
  return found;
}

TEST(Layering, LeavesDoNotKnowEachOther) {
  fs::path source = DEFORMA_SOURCE_DIR;
  for (const auto& [room, rooms] : allowed) {
    EXPECT_THAT(violations(source / room, room), testing::IsEmpty());
    if (fs::exists(source / "tests" / room)) {
      EXPECT_THAT(violations(source / "tests" / room, room, true), testing::IsEmpty());
    }
  }
}

TEST(Layering, AForbiddenIncludeIsFound) {
  fs::path folder = fs::path(testing::TempDir()) / "layering";
  fs::create_directories(folder);
  std::ofstream(folder / "bad.cpp")
      << "#include <vector>\n # include  \"render/image.hpp\"\n#include \"sim/types.hpp\"\n";
  EXPECT_THAT(violations(folder, "sim"),
              testing::ElementsAre(testing::HasSubstr("bad.cpp includes render/image.hpp")));
  fs::remove_all(folder);
}

TEST(Layering, EveryLibraryStaysInItsRoom) {
  const std::map<std::string, std::string> homes = {
      {"toml++/toml.h", "pipeline"},
      {"CLI/CLI.hpp", "pipeline"},
      {"nlohmann/json.hpp", "pipeline"},
      {"assimp/scene.h", "assets"},
      {"epoxy/gl.h", "render"},
      {"EGL/egl.h", "render"},
      {"libavcodec/avcodec.h", "render"},
      {"libswscale/swscale.h", "render"},
      {"png.h", "render"},
      {"cairo.h", "render"},
      {"gtest/gtest.h", "nowhere"},
      {"boost/any.hpp", "nowhere"},
  };
  for (const auto& [header, home] : homes)
    for (const auto& [room, rooms] : allowed)
      EXPECT_EQ(may_include(room, header, false), room == home) << room << " " << header;
}

TEST(Layering, EveryRoomHasFiles) {
  for (const auto& [room, rooms] : allowed) {
    auto files = fs::directory_iterator(fs::path(DEFORMA_SOURCE_DIR) / room);
    EXPECT_GT(std::distance(begin(files), end(files)), 5) << room;
  }
}

}  // namespace
