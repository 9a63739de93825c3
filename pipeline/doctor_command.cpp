#include <fmt/core.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipeline/commands.hpp"
#include "pipeline/report.hpp"
#include "pipeline/user_error.hpp"
#include "render/library_versions.hpp"
#include "render/renderer.hpp"
#include "render/video.hpp"
#include "sim/inner_loops.hpp"

namespace deforma {

namespace {

using json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// A folder in the system's place for temporary files, removed at the end.
class TrialFolder {
 public:
  TrialFolder() : path_(fs::temp_directory_path() / fmt::format("deforma_doctor_{}", getpid())) {
    fs::create_directories(path_);
  }
  ~TrialFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

json libraries() {
  json versions = json::object();
  for (const auto& [name, version] : library_versions()) versions[name] = version;
  // What is loaded counts, not what it was built with.
  for (const auto& [name, version] : render_library_versions()) versions[name] = version;
  return versions;
}

std::string processor_name() {
  std::ifstream lines("/proc/cpuinfo");
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

json processor() {
  json has = json::array();
  for (const Instructions set : {Instructions::baseline, Instructions::avx2, Instructions::avx2_fma})
    if (supports(set)) has.push_back(instructions_name(set));
  return {{"name", processor_name()},
          {"threads", std::thread::hardware_concurrency()},
          {"instructions", has},
          {"used", instructions_name(fastest_instructions())},
          {"used_when_portable", instructions_name(portable_instructions())}};
}

json platforms() {
  json all = json::array();
  for (const ContextFacts& facts : Context::try_all()) {
    json one = {{"platform", facts.platform}, {"works", !facts.renderer.empty() && facts.attempts.empty()}};
    if (facts.attempts.empty()) {
      one["renderer"] = facts.renderer;
      one["vendor"] = facts.vendor;
      one["version"] = facts.version;
    } else {
      one["reason"] = facts.attempts.front();
    }
    all.push_back(one);
  }
  return all;
}

json encoders() {
  json all = json::object();
  for (const std::string& container : video_containers()) all[container] = video_codecs(container);
  return all;
}

/// Fills in what `attempt` returns, or why it failed. A mistake of the user's goes on to `main`.
template <typename Attempt>
json tried(Attempt attempt) {
  try {
    json result = attempt();
    result["works"] = true;
    return result;
  } catch (const std::invalid_argument& error) {
    throw UserError(error.what());
  } catch (const std::runtime_error& error) {
    return {{"works", false}, {"reason", error.what()}};
  }
}

json draw_frame(const TrialFolder& folder, const std::string& platform, Image& image) {
  RendererSettings settings;
  settings.width = 160;
  settings.height = 90;
  Renderer renderer(settings, {platform});
  const DrawnGround ground;
  FrameContent frame;
  frame.ground = &ground;
  frame.camera.eye = {3.0, -4.0, 2.0};
  image = renderer.draw(frame);
  write_png(folder / "frame.png", image);
  if (read_png(folder / "frame.png").rgba != image.rgba)
    throw std::runtime_error("a PNG reads back otherwise");
  const ContextFacts& facts = renderer.facts();
  return {{"platform", facts.platform}, {"renderer", facts.renderer}, {"version", facts.version}};
}

json write_video(const TrialFolder& folder, const Image& image) {
  const fs::path file = folder / "video.mp4";
  VideoWriter writer(file, {image.width, image.height, 25.0});
  for (int frame = 0; frame < 3; ++frame) writer.add(image);
  writer.close();
  const VideoFacts facts = inspect_video(file);
  if (facts.frames != 3) throw std::runtime_error(fmt::format("of 3 frames {} read back", facts.frames));
  const Encoding& encoding = writer.encoding();
  return {{"container", "mp4"},
          {"codec", encoding.codec},
          {"preset", encoding.preset},
          {"pixel_format", encoding.pixel_format}};
}

std::string text_of(const json& list) {
  return fmt::format("{}", fmt::join(list.get<std::vector<std::string>>(), ", "));
}

void print_text(const json& found) {
  fmt::print("{}\n\n", version_text());
  std::vector<std::string> versions;
  for (const auto& [name, version] : found["libraries"].items())
    versions.push_back(fmt::format("{} {}", name, version.get<std::string>()));
  fmt::print("libraries   {}\n", fmt::join(versions, "\n            "));
  const json& cpu = found["processor"];
  fmt::print("processor   {}, {} threads\n            has {}; used: {}, with --portable {}\n",
             cpu["name"].get<std::string>(), cpu["threads"].get<unsigned>(), text_of(cpu["instructions"]),
             cpu["used"].get<std::string>(), cpu["used_when_portable"].get<std::string>());
  const char* head = "drawing";
  for (const json& platform : found["platforms"]) {
    if (platform["works"])
      fmt::print("{:<12}{}: {}, OpenGL {}\n", head, platform["platform"].get<std::string>(),
                 platform["renderer"].get<std::string>(), platform["version"].get<std::string>());
    else
      fmt::print("{:<12}no: {}\n", head, platform["reason"].get<std::string>());
    head = "";
  }
  head = "encoders";
  for (const auto& [container, codecs] : found["encoders"].items()) {
    fmt::print("{:<12}{}: {}\n", head, container, codecs.empty() ? "none" : text_of(codecs));
    head = "";
  }
  const json& frame = found["frame"];
  const json& video = found["video"];
  if (frame["works"])
    fmt::print("\nA frame was drawn on {} ({}).\n", frame["platform"].get<std::string>(),
               frame["renderer"].get<std::string>());
  else
    fmt::print("\nNo frame can be drawn: {}\n", frame["reason"].get<std::string>());
  if (video["works"])
    fmt::print("A video was written: {}, {}.\n", video["codec"].get<std::string>(),
               video["pixel_format"].get<std::string>());
  else
    fmt::print("No video can be written: {}\n", video["reason"].get<std::string>());
}

}  // namespace

int doctor(const DoctorCommand& command) {
  const TrialFolder folder;
  Image image{160, 90,
              std::vector<std::uint8_t>(4 * 160 * 90, 255)};  // for the video when nothing can be drawn
  json found = {{"version", version_text()}, {"libraries", libraries()}, {"processor", processor()}};
  found["platforms"] = platforms();
  found["encoders"] = encoders();
  found["frame"] = tried([&] { return draw_frame(folder, command.platform, image); });
  found["video"] = tried([&] { return write_video(folder, image); });
  const bool healthy = found["frame"]["works"].get<bool>() && found["video"]["works"].get<bool>();
  found["healthy"] = healthy;
  if (command.json)
    fmt::print("{}\n", found.dump(2));
  else
    print_text(found);
  return healthy ? exit_ok : exit_failure;
}

}  // namespace deforma
