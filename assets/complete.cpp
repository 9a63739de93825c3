#include "assets/complete.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace deforma {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, std::string_view what) {
  throw std::runtime_error(fmt::format("{}: {}", file.string(), what));
}

struct Property {
  std::string type;
  std::string count_type;  ///< of the length in front of a list; empty for a single value
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// What a PLY header announces.
/// Source: Turk 1994, "The PLY polygon file format".
class Ply {
 public:
  Ply(const std::filesystem::path& file, std::istream& in) : file_(file), in_(in) {
    std::string line;
    while (std::getline(in, line)) {
      std::istringstream words(line);
      std::string word;
      words >> word;
      if (word == "end_header") return;
      if (word == "format") words >> format_;
      if (word == "element") {
        elements_.emplace_back();
        words >> elements_.back().name >> elements_.back().count;
      }
      if (word == "property") read_property(words);
    }
    refuse(file_, "the file is cut off in its header");
  }

  void check_body() {
    for (const Element& element : elements_)
      for (std::uint64_t i = 0; i < element.count; ++i)
        for (const Property& property : element.properties)
          if (!skip(property))
            refuse(file_, fmt::format("the file is cut off: {} of element '{}' announced, {} found",
                                      element.count, element.name, i));
  }

 private:
  void read_property(std::istringstream& words) {
    if (elements_.empty()) refuse(file_, "a property without an element in its header");
    Property property;
    words >> property.type;
    if (property.type == "list") words >> property.count_type >> property.type;
    size_of(property.type);
    elements_.back().properties.push_back(property);
  }

  std::size_t size_of(const std::string& type) const {
    static const std::map<std::string, std::size_t> sizes = {
        {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
        {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
        {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
    auto size = sizes.find(type);
    if (size == sizes.end()) refuse(file_, fmt::format("unknown type '{}' in its header", type));
    return size->second;
  }

  bool skip(const Property& property) {
    std::uint64_t values = 1;
    if (!property.count_type.empty() && !read_count(property.count_type, values)) return false;
    if (format_ == "ascii") {
      std::string word;
      for (; values > 0 && in_ >> word; --values) continue;
      return values == 0;
    }
    // Read, not sought: seeking beyond the end succeeds.
    std::uint64_t bytes = values * size_of(property.type);
    in_.ignore(static_cast<std::streamsize>(bytes));
    return static_cast<std::uint64_t>(in_.gcount()) == bytes;
  }

  bool read_count(const std::string& type, std::uint64_t& count) {
    if (format_ == "ascii") return static_cast<bool>(in_ >> count);
    char bytes[8] = {};
    std::size_t size = size_of(type);
    if (!in_.read(bytes, static_cast<std::streamsize>(size))) return false;
    bool file_is_big = format_ == "binary_big_endian";
    count = 0;
    for (std::size_t i = 0; i < size; ++i)
      count |= std::uint64_t{static_cast<unsigned char>(bytes[file_is_big ? size - 1 - i : i])} << (8 * i);
    return true;
  }

  const std::filesystem::path& file_;
  std::istream& in_;
  std::string format_;
  std::vector<Element> elements_;
};

/// The next line of an OFF file that is neither blank nor a comment.
bool next_line(std::istream& in, std::istringstream& words) {
  std::string line;
  while (std::getline(in, line)) {
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    words = std::istringstream(line);
    return true;
  }
  return false;
}

/// @param line the first one, with the keyword and perhaps the counts
void check_off(const std::filesystem::path& file, std::istream& in, std::istringstream line) {
  std::string keyword;
  line >> keyword;
  std::int64_t points = -1, faces = -1;
  if (!(line >> points >> faces)) {
    if (!next_line(in, line) || !(line >> points >> faces)) refuse(file, "the file is cut off in its header");
  }
  for (std::int64_t i = 0; i < points; ++i) {
    double x, y, z;
    if (!next_line(in, line))
      refuse(file, fmt::format("the file is cut off: {} points announced, {} found", points, i));
    // A number that the stream does not know (nan) is the importer's to judge; a missing one is a cut.
    if (!(line >> x >> y >> z) && line.eof())
      refuse(file, fmt::format("point {} has fewer than three coordinates", i));
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    std::int64_t corners = 0;
    if (!next_line(in, line) || !(line >> corners))
      refuse(file, fmt::format("the file is cut off: {} faces announced, {} found", faces, i));
    for (std::int64_t c = 0; c < corners; ++c) {
      std::int64_t point = 0;
      if (!(line >> point))
        refuse(file, fmt::format("face {} announces {} corners, {} found", i, corners, c));
      if (point < 0 || point >= points)
        refuse(file, fmt::format("face {} names vertex {}, but there are {}", i, point, points));
    }
  }
}

/// A text STL file ends with "endsolid"; without it the importer takes what is there for the whole.
void check_stl(const std::filesystem::path& file, std::istream& in) {
  auto size = std::filesystem::file_size(file);
  std::string tail(std::min<std::uintmax_t>(size, 512), ' ');
  in.seekg(-static_cast<std::streamoff>(tail.size()), std::ios::end);
  in.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (tail.find("endsolid") == std::string::npos) refuse(file, "the file is cut off: no endsolid at its end");
}

/// Binary STL files may begin with "solid" as well; only there do the facets follow as numbers.
bool is_text_stl(const std::string& start) {
  return start.starts_with("solid") && start.find("facet") != std::string::npos;
}

}  // namespace

void check_complete(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string first;
  first.resize(256);
  in.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(in.gcount()));
  in.clear();
  in.seekg(0);
  std::istringstream start(first);
  std::string word;
  start >> word;
  if (word == "ply") {
    Ply(file, in).check_body();
  } else if (word == "OFF" || word == "COFF" || word == "NOFF" || word == "CNOFF") {
    std::istringstream line;
    next_line(in, line);
    if (first.find("BINARY") == std::string::npos) check_off(file, in, std::move(line));
  } else if (is_text_stl(first)) {
    check_stl(file, in);
  }
}

}  // namespace deforma
