#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

// What the program uses of oneTBB, over plain threads. ThreadSanitizer, which does not see how a stock oneTBB hands work
// over, then knows exactly what may run beside what. Every loop is shared out, however short it is and however busy the
// machine: part k goes to the k-th thread and to no other. Loops nest.

namespace tbb {

namespace plain {

/// More than most machines that run the tests have: races are found by what is ordered, not by what happens to overlap.
inline constexpr std::size_t usual_width = 4;

/// The most threads that a loop of this program may use, of `global_control`.
inline std::atomic<std::size_t>& limit() {
  static std::atomic<std::size_t> value = usual_width;
  return value;
}

/// How many the arena allows that the calling thread is in.
inline std::size_t& arena_width() {
  thread_local std::size_t width = usual_width;
  return width;
}

/// A thread that waits for something to do.
class Worker {
 public:
  ~Worker() {
    begin({});
    thread_.join();
  }

  /// Nothing to do ends it.
  void begin(std::function<void()> job) {
    std::lock_guard lock(mutex_);
    job_ = std::move(job);
    at_work_ = true;
    changed_.notify_all();
  }

  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !at_work_; });
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return at_work_; });
      if (!job_) return;
      lock.unlock();
      job_();
      lock.lock();
      at_work_ = false;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> job_;
  bool at_work_ = false;
  std::thread thread_{[this] { work(); }};
};

/// The workers of the calling thread's loops, kept for its next ones: those of a loop, of the loops inside it, and so on.
struct Crews {
  std::deque<std::deque<Worker>> of_depth;
  std::size_t depth = 0;
};

inline Crews& crews() {
  thread_local Crews own;
  return own;
}

/// Calls `part(begin, end)` for a share of [begin, end) on every thread, and rethrows the first failure.
template <typename Part>
void share_out(std::size_t begin, std::size_t end, const Part& part) {
  const std::size_t count = end > begin ? end - begin : 0;
  const std::size_t width = arena_width();
  const std::size_t threads = std::min({count, width, limit().load()});
  if (threads == 0) return;
  std::mutex mutex;
  std::exception_ptr failure;
  auto run = [&](std::size_t t) {
    try {
      arena_width() = width;
      part(begin + count * t / threads, begin + count * (t + 1) / threads);
    } catch (...) {
      std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  Crews& own = crews();
  if (own.of_depth.size() == own.depth) own.of_depth.emplace_back();
  std::deque<Worker>& crew = own.of_depth[own.depth++];
  while (crew.size() + 1 < threads) crew.emplace_back();
  for (std::size_t t = 1; t < threads; ++t) crew[t - 1].begin([&run, t] { run(t); });
  run(0);
  for (std::size_t t = 1; t < threads; ++t) crew[t - 1].wait();
  --own.depth;
  if (failure) std::rethrow_exception(failure);
}

}  // namespace plain

template <typename Value>
class blocked_range {
 public:
  blocked_range(Value begin, Value end, std::size_t = 1) : begin_(begin), end_(end) {}
  Value begin() const { return begin_; }
  Value end() const { return end_; }

 private:
  Value begin_, end_;
};

struct simple_partitioner {};

template <typename Value, typename Body>
void parallel_for(const blocked_range<Value>& range, const Body& body, const simple_partitioner& = {}) {
  plain::share_out(range.begin(), range.end(),
                   [&](std::size_t begin, std::size_t end) { body(blocked_range<Value>(begin, end)); });
}

template <typename Body>
void parallel_for(std::size_t begin, std::size_t end, const Body& body) {
  plain::share_out(begin, end, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i != last; ++i) body(i);
  });
}

template <typename Iterator>
void parallel_sort(Iterator begin, Iterator end) {
  std::sort(begin, end);
}

/// A value for each thread that asks.
template <typename Value>
class enumerable_thread_specific {
 public:
  Value& local() {
    std::lock_guard lock(mutex_);
    return values_[std::this_thread::get_id()];
  }

 private:
  std::mutex mutex_;
  std::map<std::thread::id, Value> values_;
};

class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, std::size_t most) : before_(plain::limit().exchange(most)) {}
  ~global_control() { plain::limit() = before_; }
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;

 private:
  std::size_t before_;
};

class task_arena {
 public:
  explicit task_arena(int width) : width_(static_cast<std::size_t>(width)) {}

  template <typename Body>
  auto execute(const Body& body) {
    struct Inside {
      explicit Inside(std::size_t width) : before(std::exchange(plain::arena_width(), width)) {}
      ~Inside() { plain::arena_width() = before; }
      std::size_t before;
    } inside(width_);
    return body();
  }

 private:
  std::size_t width_;
};

}  // namespace tbb
