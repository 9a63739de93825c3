#include <unistd.h>

#include <filesystem>

#include "pipeline/drawing.hpp"
#include "pipeline/files.hpp"
#include "pipeline/framing.hpp"
#include "render/image.hpp"
#include "render/renderer.hpp"
#include "render/video.hpp"
#include "tests/bench/bodies.hpp"

// Frames of a shipped scene: drawn, and written, in the size that a scene gets that asks for none.
namespace deforma {

namespace {

namespace fs = std::filesystem;

struct Shown {
  Scene scene = load_scene(find_scene("cylinder_in_cylinder"));
  World world = build(scene);

  Shown() { frame_scene(scene, world.solver->state()); }

  Renderer renderer() const { return Renderer(renderer_settings(scene)); }
  Image draw(Renderer& renderer) const {
    Drawing drawing(scene, world.solver->state());
    const Snapshot snapshot = take_snapshot(scene, *world.solver, 1);
    return renderer.draw(drawing.content(snapshot));
  }
};

/// Where a case may write, gone at its end.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& ending)
      : path_(fs::temp_directory_path() / ("deforma-bench-" + std::to_string(getpid()) + ending)) {}
  ~ScratchFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void measure_drawing(benchmark::State& iterations) {
  const Shown shown;
  Renderer renderer = shown.renderer();
  for (auto _ : iterations) benchmark::DoNotOptimize(shown.draw(renderer));
}

void measure_png(benchmark::State& iterations) {
  const Shown shown;
  Renderer renderer = shown.renderer();
  const Image image = shown.draw(renderer);
  const ScratchFile file(".png");
  for (auto _ : iterations) write_png(file.path(), image);
}

void measure_video(benchmark::State& iterations) {
  Shown shown;
  Renderer renderer = shown.renderer();
  std::vector<Image> images;  // of a body that moves: a picture that stays costs nothing to encode
  for (int frame = 0; frame < 24; ++frame) {
    images.push_back(shown.draw(renderer));
    shown.world.solver->advance(1.0 / shown.scene.fps);
  }
  const ScratchFile file(".mp4");
  VideoWriter video(file.path(), {shown.scene.output.width, shown.scene.output.height, shown.scene.fps});
  std::size_t next = 0;
  for (auto _ : iterations) video.add(images[next++ % images.size()]);
}

}  // namespace

void add_frame_cases() {
  auto add = [](const char* name, void (*measure)(benchmark::State&)) {
    benchmark::RegisterBenchmark(name, measure)->Unit(benchmark::kMillisecond)->UseRealTime();
  };
  add("draw", measure_drawing);
  add("png", measure_png);
  add("video", measure_video);
}

}  // namespace deforma
