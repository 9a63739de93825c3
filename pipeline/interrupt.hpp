#pragma once

namespace deforma {

/// While it lives, the first Ctrl-C or SIGTERM only asks the run to end after the current frame; the second
/// ends the program.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  int signal() const;  ///< the one received, or 0
};

}  // namespace deforma
