#pragma once

#include "render/gl.hpp"
#include "render/image.hpp"
#include "render/quality.hpp"
#include "render/scene_fit.hpp"
#include "render/shaders.hpp"

namespace deforma {

/// Where a picture is drawn. The part that needs its edges smoothed goes to a fine target with many samples per pixel, which
/// is then resolved into the plain one; without antialiasing both are one and nothing needs resolving.
class PictureTarget {
 public:
  /// @param width, height of the picture [pixels]
  PictureTarget(int width, int height);

  /// Makes the buffers for it, unless they are there. What the driver does not offer is lowered to what it does.
  void use(const Antialiasing& wanted);

  const Antialiasing& antialiasing() const { return antialiasing_; }
  bool is_plain() const { return antialiasing_ == Antialiasing{}; }

  /// Offsets of a pixel's samples from its middle, in pixels of the fine target; a column each.
  const Eigen::Matrix<float, 4, max_samples>& samples() const { return samples_; }

  /// Draw to all of the plain picture from now on, or to all of the fine one.
  void bind_plain() const;
  void bind_fine() const;
  /// Lets only a box of the picture be changed, in whichever is bound.
  void clip_plain(const PixelBox& box) const;
  void clip_fine(const PixelBox& box) const;

  /// Brings a box of the fine picture into the plain one.
  void resolve(const PixelBox& box) const;

  /// The plain picture, its rows from the top.
  Image read() const;

 private:
  struct Buffers {
    gl::Renderbuffer color, depth;
    gl::Framebuffer target;
  };
  static int make(const Buffers& buffers, int width, int height, int samples, const char* what);

  int width_, height_;
  Antialiasing wanted_, antialiasing_;
  Buffers plain_, fine_;
  Buffers wide_;  ///< between the two with both kinds of antialiasing: fine, but one sample per pixel
  Eigen::Matrix<float, 4, max_samples> samples_ = Eigen::Matrix<float, 4, max_samples>::Zero();
};

}  // namespace deforma
