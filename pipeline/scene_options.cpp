#include "pipeline/scene_options.hpp"

#include <fmt/core.h>

#include <array>
#include <charconv>

#include "pipeline/files.hpp"
#include "pipeline/user_error.hpp"

namespace deforma {

namespace {

std::optional<int> whole_number(const std::string& text) {
  int number = 0;
  auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

Scene SceneOptions::load() const {
  std::vector<Override> overrides;
  for (const std::string& set : sets) overrides.push_back(parse_override(set));
  if (!size.empty()) {
    std::size_t x = size.find('x');
    std::optional<int> width = whole_number(size.substr(0, x));
    std::optional<int> height = x == size.npos ? std::nullopt : whole_number(size.substr(x + 1));
    if (!width || !height) throw UserError(fmt::format("--size {}: expected WxH, such as 1280x720", size));
    overrides.push_back({"output.size", fmt::format("[{}, {}]", *width, *height), "--size " + size});
  }
  if (transparent) overrides.push_back({"output.transparent", "true", "--transparent"});
  if (portable) overrides.push_back({"solver.portable", "true", "--portable"});
  const std::array<std::array<std::string, 3>, 9> plain = {{{"view", "view", view},
                                                            {"quality", "quality", quality},
                                                            {"color-by", "color_by", color_by},
                                                            {"color-map", "color_map", color_map},
                                                            {"video", "video", video},
                                                            {"codec", "codec", codec},
                                                            {"preset", "preset", preset},
                                                            {"pix-fmt", "pix_fmt", pixel_format},
                                                            {"crf", "crf", crf}}};
  for (const auto& [option, key, value] : plain)
    if (!value.empty()) overrides.push_back({"output." + key, value, fmt::format("--{} {}", option, value)});
  if (!color_range.empty()) {
    const std::size_t colon = color_range.find(':');
    if (colon == color_range.npos)
      throw UserError(fmt::format("--color-range {}: expected LOW:HIGH, such as 0:2e4", color_range));
    overrides.push_back({"output.color_range",
                         fmt::format("[{}, {}]", color_range.substr(0, colon), color_range.substr(colon + 1)),
                         "--color-range " + color_range});
  }
  return load_scene(find_scene(scene), overrides);
}

FrameRange parse_frames(const std::string& text, int last_frame) {
  std::size_t colon = text.find(':');
  std::string first_text = text.substr(0, colon);
  std::string last_text = colon == text.npos ? first_text : text.substr(colon + 1);
  std::optional<int> first = first_text.empty() ? 1 : whole_number(first_text);
  std::optional<int> last = last_text.empty() ? last_frame : whole_number(last_text);
  bool valid = text.size() > 1 || (colon == text.npos && !text.empty());
  if (!valid || !first || !last)
    throw UserError(fmt::format("--frames {}: expected A:B, such as 1:25", text));
  if (*first < 1 || *last < *first || *last > last_frame)
    throw UserError(fmt::format("--frames {}: outside the scene's frames 1:{}", text, last_frame));
  return {*first, *last};
}

}  // namespace deforma
