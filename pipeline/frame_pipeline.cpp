#include "pipeline/frame_pipeline.hpp"

#include <optional>

#include "pipeline/stopwatch.hpp"

namespace deforma {

FramePipeline::FramePipeline(const RendererSettings& settings, const ContextRequest& request)
    : drawer_([this, settings, request] { draw_frames(settings, request); }) {}

FramePipeline::~FramePipeline() { abandon(); }

void FramePipeline::abandon() {
  snapshots_.abandon();
  images_.abandon();
  stop();
}

ContextFacts FramePipeline::ready() { return context_.get_future().get(); }

void FramePipeline::start(Draw draw, Write write) {
  // The queue's lock makes these visible to the drawing thread before its first snapshot.
  draw_ = std::move(draw);
  write_ = std::move(write);
  writer_ = std::thread([this] { write_frames(); });
}

void FramePipeline::push(Snapshot snapshot) {
  if (!snapshots_.push(std::move(snapshot))) finish();
}

void FramePipeline::finish() {
  snapshots_.close();
  stop();
  // The writer's failure is the cause when both failed.
  if (write_failure_) std::rethrow_exception(write_failure_);
  if (draw_failure_) std::rethrow_exception(draw_failure_);
}

void FramePipeline::stop() {
  if (drawer_.joinable()) drawer_.join();
  images_.close();
  if (writer_.joinable()) writer_.join();
}

void FramePipeline::draw_frames(const RendererSettings& settings, const ContextRequest& request) {
  std::optional<Renderer> renderer;
  try {
    renderer.emplace(settings, request);
    context_.set_value(renderer->facts());
  } catch (...) {
    context_.set_exception(std::current_exception());
    snapshots_.abandon();
    return;
  }
  try {
    Stopwatch watch;
    while (std::optional<Snapshot> snapshot = snapshots_.pop()) {
      drawing_.wait += watch.lap();
      Image image = draw_(*renderer, *snapshot);
      drawing_.busy += watch.lap();
      if (!images_.push({snapshot->frame, std::move(image)})) {
        snapshots_.abandon();
        return;
      }
    }
    drawing_.wait += watch.lap();
  } catch (...) {
    draw_failure_ = std::current_exception();
    snapshots_.abandon();
  }
}

void FramePipeline::write_frames() {
  try {
    Stopwatch watch;
    while (std::optional<std::pair<int, Image>> image = images_.pop()) {
      writing_.wait += watch.lap();
      write_(image->first, image->second);
      writing_.busy += watch.lap();
    }
    writing_.wait += watch.lap();
  } catch (...) {
    write_failure_ = std::current_exception();
    images_.abandon();
    snapshots_.abandon();
  }
}

}  // namespace deforma
