#pragma once

#include <memory>
#include <string>
#include <vector>

namespace deforma {

/// Which way to an OpenGL context to take.
struct ContextRequest {
  /// "auto" tries every EGL device in turn, then the surfaceless platform, then the default display;
  /// "device:N", "surfaceless" and "default" take only that one.
  std::string platform = "auto";
};

/// What was taken, for reports.
struct ContextFacts {
  std::string platform;  ///< "device:0", "surfaceless", "default"
  std::string vendor;
  std::string renderer;
  std::string version;
  std::vector<std::string> attempts;  ///< those that failed before it, each with its reason
};

/// An OpenGL core context without a window, current on the thread that made it.
class Context {
 public:
  /// Of each platform the whole chain is tried, down to one pixel drawn and read back, before the next is taken.
  /// @throws std::runtime_error listing every attempt with its EGL error, and what the environment says to the driver,
  /// when none works;
  /// std::invalid_argument for a platform name that is none of the above or a device that EGL does not list; the
  /// message lists what there is.
  explicit Context(const ContextRequest& request = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const ContextFacts& facts() const;

  /// Tries every platform that "auto" would, each for itself. What works has a renderer, what does not one attempt with
  /// its reason. The platform is named with its device's file, where it has one. Empty without an EGL library.
  static std::vector<ContextFacts> try_all();

  /// Binds it to the calling thread, where another context may have been made since.
  /// @throws std::runtime_error with the EGL error.
  void make_current() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace deforma
