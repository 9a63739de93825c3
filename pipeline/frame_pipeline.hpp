#pragma once

#include <exception>
#include <functional>
#include <future>
#include <thread>

#include "pipeline/bounded_queue.hpp"
#include "pipeline/drawing.hpp"
#include "render/renderer.hpp"

namespace deforma {

/// Draws and writes frames on two threads of their own, while the caller simulates the next.
///
/// The drawing thread owns the OpenGL context. A failure on any thread stops both and is thrown by `push` or
/// `finish`.
class FramePipeline {
 public:
  using Draw = std::function<Image(Renderer&, const Snapshot&)>;
  using Write = std::function<void(int frame, const Image&)>;

  /// Time a thread worked and waited for others [s].
  struct Load {
    double busy = 0.0;
    double wait = 0.0;
  };

  /// Starts the drawing thread, which begins to make its renderer at once.
  FramePipeline(const RendererSettings& settings, const ContextRequest& request);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Waits for the renderer. @throws what its constructor threw.
  ContextFacts ready();

  /// Starts the writing thread; both callbacks run on their own thread, frame after frame. Once, after
  /// `ready`.
  void start(Draw draw, Write write);

  /// Hands over the next frame, waiting while too many are under way. @throws what failed on another thread.
  void push(Snapshot snapshot);

  /// Waits until every frame is written. @throws what failed on another thread.
  void finish();

  /// Stops both threads and drops what is under way. Needed before what the callbacks refer to goes away.
  void abandon();

  const Load& drawing() const { return drawing_; }  ///< after `finish`
  const Load& writing() const { return writing_; }  ///< after `finish`

 private:
  void draw_frames(const RendererSettings& settings, const ContextRequest& request);
  void write_frames();
  void stop();

  BoundedQueue<Snapshot> snapshots_{2};
  BoundedQueue<std::pair<int, Image>> images_{2};
  std::promise<ContextFacts> context_;
  Draw draw_;
  Write write_;
  Load drawing_, writing_;
  std::exception_ptr draw_failure_, write_failure_;
  std::thread drawer_, writer_;
};

}  // namespace deforma
