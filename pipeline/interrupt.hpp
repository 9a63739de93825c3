#pragma once

namespace deforma {

/// While it lives, the first Ctrl-C only asks the run to end after the current frame; the second ends the
/// program.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool requested() const;
};

}  // namespace deforma
