#include "pipeline/frame_pipeline.hpp"

#include <optional>

namespace deforma {

FramePipeline::FramePipeline(const RendererSettings& settings, const ContextRequest& request)
    : drawer_([this, settings, request] { draw_frames(settings, request); }) {}

FramePipeline::~FramePipeline() { abandon(); }

void FramePipeline::abandon() {
  drop_all();
  stop();
}

ContextFacts FramePipeline::ready() { return context_.get_future().get(); }

void FramePipeline::start(Draw draw, std::vector<Write> writers) {
  // The queue's lock makes these visible to the drawing thread before its first snapshot.
  draw_ = std::move(draw);
  drawing_watch_ = Stopwatch();
  for (Write& write : writers) writers_.emplace_back().write = std::move(write);
  // Only now, for each of them knows the others.
  for (Writer& writer : writers_) writer.thread = std::thread([this, &writer] { write_frames(writer); });
}

void FramePipeline::push(Snapshot snapshot) {
  if (!snapshots_.push(std::move(snapshot))) finish();
}

void FramePipeline::finish() {
  snapshots_.close();
  stop();
  // A writer's failure is the cause when the drawing failed, too.
  for (const Writer& writer : writers_)
    if (writer.failure) std::rethrow_exception(writer.failure);
  if (draw_failure_) std::rethrow_exception(draw_failure_);
}

void FramePipeline::drop_all() {
  snapshots_.abandon();
  for (Writer& writer : writers_) writer.images.abandon();
}

void FramePipeline::stop() {
  if (drawer_.joinable()) drawer_.join();
  for (Writer& writer : writers_) writer.images.close();
  for (Writer& writer : writers_)
    if (writer.thread.joinable()) writer.thread.join();
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
    while (std::optional<Snapshot> snapshot = snapshots_.pop()) {
      drawing_.wait += drawing_watch_.lap();
      auto image = std::make_shared<const Image>(draw_(*renderer, *snapshot));
      drawing_.busy += drawing_watch_.lap();
      if (!hand_out({snapshot->frame, std::move(image)})) return;
    }
    drawing_.wait += drawing_watch_.lap();
  } catch (...) {
    draw_failure_ = std::current_exception();
    snapshots_.abandon();
  }
}

bool FramePipeline::hand_out(const Drawn& drawn) {
  for (Writer& writer : writers_)
    if (!writer.images.push(drawn)) return false;
  return true;
}

void FramePipeline::write_frames(Writer& writer) {
  try {
    Stopwatch watch;
    while (std::optional<Drawn> drawn = writer.images.pop()) {
      writer.load.wait += watch.lap();
      writer.write(drawn->frame, *drawn->image);
      writer.load.busy += watch.lap();
    }
    writer.load.wait += watch.lap();
  } catch (...) {
    writer.failure = std::current_exception();
    drop_all();
  }
}

}  // namespace deforma
