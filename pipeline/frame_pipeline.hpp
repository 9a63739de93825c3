#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "pipeline/bounded_queue.hpp"
#include "pipeline/drawing.hpp"
#include "pipeline/stopwatch.hpp"
#include "render/renderer.hpp"

namespace deforma {

/// Draws frames on a thread of its own and hands each to several others, which write it at the same time, while the
/// caller simulates the next. No thread is more than a few frames ahead of the one it works for.
///
/// The drawing thread owns the OpenGL context. A failure on any thread stops all and is thrown by `push` or
/// `finish`.
class FramePipeline {
 public:
  using Draw = std::function<Image(Renderer&, const Snapshot&)>;
  using Write = std::function<void(int frame, const Image&)>;

  /// Starts the drawing thread, which begins to make its renderer at once.
  FramePipeline(const RendererSettings& settings, const ContextRequest& request);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Waits for the renderer. @throws what its constructor threw.
  ContextFacts ready();

  /// Starts a thread for each of the writers; every callback runs on its own thread alone, frame after frame. Once,
  /// after `ready`.
  void start(Draw draw, std::vector<Write> writers);

  /// Hands over the next frame, waiting while too many are under way. @throws what failed on another thread.
  void push(Snapshot snapshot);

  /// Waits until every frame is written. @throws what failed on another thread: of several the first writer's.
  void finish();

  /// Stops all threads and drops what is under way. Needed before what the callbacks refer to goes away.
  void abandon();

  const Load& drawing() const { return drawing_; }  ///< from `start` on; to be read after `finish`
  const Load& writing(std::size_t writer) const { return writers_[writer].load; }  ///< likewise

 private:
  /// Nobody changes an image any more once it is shared.
  struct Drawn {
    int frame;
    std::shared_ptr<const Image> image;
  };
  struct Writer {
    Write write;
    BoundedQueue<Drawn> images{2};
    Load load;
    std::exception_ptr failure;
    std::thread thread;
  };

  void draw_frames(const RendererSettings& settings, const ContextRequest& request);
  bool hand_out(const Drawn& drawn);
  void write_frames(Writer& writer);
  void drop_all();
  void stop();

  BoundedQueue<Snapshot> snapshots_{2};
  std::promise<ContextFacts> context_;
  Draw draw_;
  std::deque<Writer> writers_;
  Stopwatch drawing_watch_;
  Load drawing_;
  std::exception_ptr draw_failure_;
  std::thread drawer_;
};

}  // namespace deforma
