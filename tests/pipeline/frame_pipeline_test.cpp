#include "pipeline/frame_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>

namespace deforma {
namespace {

using Write = FramePipeline::Write;

RendererSettings small() {
  RendererSettings settings;
  settings.width = 16;
  settings.height = 16;
  settings.detail.antialiasing.samples = 1;
  return settings;
}

/// A picture whose width is the frame it shows.
Image marked(const Snapshot& snapshot) { return {snapshot.frame, 1, {}}; }

/// Runs frames 1 to `last` through a pipeline that does not really draw.
void run_frames(int last, std::vector<Write> writers,
                const std::function<Image(const Snapshot&)>& draw = marked) {
  FramePipeline pipeline(small(), {});
  pipeline.ready();
  pipeline.start([&](Renderer&, const Snapshot& snapshot) { return draw(snapshot); }, std::move(writers));
  for (int frame = 1; frame <= last; ++frame) pipeline.push({frame, 0.0, {}, {}});
  pipeline.finish();
}

/// Lets whoever comes wait until two are there.
class Meeting {
 public:
  bool both_came() {
    std::unique_lock lock(mutex_);
    ++came_;
    const int round = (came_ + 1) / 2;
    changed_.notify_all();
    return changed_.wait_for(lock, std::chrono::seconds(60), [&] { return came_ >= 2 * round; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int came_ = 0;
};

TEST(FramePipeline, EveryWriterGetsEveryFrameInOrder) {
  std::vector<int> frames[2];
  std::vector<Write> writers;
  for (std::vector<int>& seen : frames)
    writers.push_back([&](int frame, const Image& image) {
      EXPECT_EQ(image.width, frame);
      seen.push_back(frame);
    });
  run_frames(20, writers);
  std::vector<int> all(20);
  std::iota(all.begin(), all.end(), 1);
  EXPECT_EQ(frames[0], all);
  EXPECT_EQ(frames[1], all);
}

TEST(FramePipeline, AFrameIsWrittenByAllAtOnce) {
  Meeting meeting;
  // On one thread the first would wait for the second forever.
  Write write = [&](int frame, const Image&) { EXPECT_TRUE(meeting.both_came()) << frame; };
  run_frames(5, {write, write});
}

TEST(FramePipeline, TheNextFrameIsDrawnWhileOneIsWritten) {
  Meeting meeting;
  constexpr int last = 6;
  Write write = [&](int frame, const Image&) { EXPECT_TRUE(frame == last || meeting.both_came()) << frame; };
  run_frames(last, {write}, [&](const Snapshot& snapshot) {
    EXPECT_TRUE(snapshot.frame == 1 || meeting.both_came()) << snapshot.frame;
    return marked(snapshot);
  });
}

TEST(FramePipeline, AFailureAnywhereEndsEveryThreadAndIsTold) {
  auto fails_at = [](int bad, const std::string& message) {
    return [bad, message](int frame, const Image&) {
      if (frame == bad) throw std::runtime_error(message);
    };
  };
  auto message_of = [](auto&& run) -> std::string {
    try {
      run();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const Write good = [](int, const Image&) {};
  EXPECT_EQ(message_of([&] { run_frames(50, {fails_at(3, "png"), good}); }), "png");
  EXPECT_EQ(message_of([&] { run_frames(50, {good, fails_at(3, "video")}); }), "video");
  // In the last frame only `finish` can tell.
  EXPECT_EQ(message_of([&] { run_frames(5, {good, fails_at(5, "video")}); }), "video");
  // When several fail at once the first is told.
  Meeting meeting;
  auto fails_with_another = [&](const std::string& message) {
    return [&meeting, message](int, const Image&) {
      EXPECT_TRUE(meeting.both_came());
      throw std::runtime_error(message);
    };
  };
  EXPECT_EQ(message_of([&] {
              run_frames(5, {fails_with_another("png"), fails_with_another("video")});
            }),
            "png");
  EXPECT_EQ(message_of([&] {
              run_frames(50, {good, good}, [](const Snapshot& snapshot) -> Image {
                if (snapshot.frame == 4) throw std::runtime_error("draw");
                return marked(snapshot);
              });
            }),
            "draw");
}

TEST(FramePipeline, CanBeAbandonedAtAnyTime) {
  FramePipeline never_started(small(), {});
  never_started.abandon();
  FramePipeline pipeline(small(), {});
  pipeline.ready();
  pipeline.start([](Renderer&, const Snapshot& snapshot) { return marked(snapshot); },
                 {[](int, const Image&) {}, [](int, const Image&) {}});
  pipeline.push({1, 0.0, {}, {}});
  pipeline.abandon();
}

}  // namespace
}  // namespace deforma
