#pragma once

#include <array>
#include <cstdint>

#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace deforma {

/// Finds when the driver was done with each pass of a frame, without waiting for it: marks are timer queries, read after the
/// picture has come back, when all of them are known.
class PassClock {
 public:
  PassClock();

  void begin_frame();  ///< now
  void end_upload();   ///< now: it is this thread's own work
  void end_shadow();   ///< when the driver gets there, as the next two; may be left out when there is none
  void end_shading();
  void end_resolve();

  /// Adds the frame, whose picture has been read back, to `cost`.
  void end_frame(DrawingCost& cost);

 private:
  bool works_ = false;  ///< whether the driver has a clock; without one nothing is added but the frame
  std::array<gl::Query, 3> marks_;
  bool has_shadow_ = false;
  std::int64_t begin_ = 0, uploaded_ = 0;  ///< by the driver's clock [ns]
};

}  // namespace deforma
