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

/// The room of every include between rooms that a text makes.
std::vector<std::string> included_rooms(std::istream& text) {
  std::vector<std::string> rooms;
  for (std::string line; std::getline(text, line);) {
    line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return c == ' ' || c == '\t'; }),
               line.end());
    if (line.rfind("#include\"", 0) != 0 && line.rfind("#include<", 0) != 0) continue;
    std::string file = line.substr(std::string("#include<").size());
    std::string room = file.substr(0, file.find('/'));
    if (allowed.count(room)) rooms.push_back(room);
  }
  return rooms;
}

/// "FILE includes ROOM" for each include that crosses the layout.
std::vector<std::string> violations(const fs::path& folder, const std::string& room) {
  std::vector<std::string> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string extension = entry.path().extension();
    if (extension != ".hpp" && extension != ".cpp") continue;
    std::ifstream text(entry.path());
    for (const std::string& included : included_rooms(text))
      if (!allowed.at(room).count(included)) found.push_back(entry.path().string() + " includes " + included);
  }
  return found;
}

TEST(Layering, LeavesDoNotKnowEachOther) {
  fs::path source = DEFORMA_SOURCE_DIR;
  for (const auto& [room, rooms] : allowed) {
    EXPECT_THAT(violations(source / room, room), testing::IsEmpty());
    if (fs::exists(source / "tests" / room)) {
      EXPECT_THAT(violations(source / "tests" / room, room), testing::IsEmpty());
    }
  }
}

TEST(Layering, AForbiddenIncludeIsFound) {
  fs::path folder = fs::path(testing::TempDir()) / "layering";
  fs::create_directories(folder);
  std::ofstream(folder / "bad.cpp")
      << "#include <vector>\n # include  \"render/image.hpp\"\n#include \"sim/types.hpp\"\n";
  EXPECT_THAT(violations(folder, "sim"), testing::ElementsAre(testing::HasSubstr("bad.cpp includes render")));
  fs::remove_all(folder);
}

TEST(Layering, EveryRoomHasFiles) {
  for (const auto& [room, rooms] : allowed) {
    auto files = fs::directory_iterator(fs::path(DEFORMA_SOURCE_DIR) / room);
    EXPECT_GT(std::distance(begin(files), end(files)), 5) << room;
  }
}

}  // namespace
