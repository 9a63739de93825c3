#include "render/picture_target.hpp"

#include <algorithm>

namespace deforma {

PictureTarget::PictureTarget(int width, int height) : width_(width), height_(height) {
  make(plain_, width, height, 1, "the picture");
}

/// Says how many samples the driver has granted.
int PictureTarget::make(const Buffers& buffers, int width, int height, int samples, const char* what) {
  // One sample is what a target without multisampling has.
  const GLsizei multisamples = samples > 1 ? samples : 0;
  glBindRenderbuffer(GL_RENDERBUFFER, buffers.color.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, multisamples, GL_SRGB8_ALPHA8, width, height);
  glBindRenderbuffer(GL_RENDERBUFFER, buffers.depth.id());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, multisamples, GL_DEPTH_COMPONENT32F, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, buffers.target.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers.color.id());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers.depth.id());
  gl::check_framebuffer(what);
  GLint granted = 0;
  glGetIntegerv(GL_SAMPLES, &granted);
  gl::check_errors("making the picture's buffers");
  return std::max(static_cast<int>(granted), 1);
}

void PictureTarget::use(const Antialiasing& wanted) {
  if (wanted == wanted_) return;
  wanted_ = wanted;
  GLint most = 1, largest = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  antialiasing_.samples = std::min({wanted.samples, static_cast<int>(most), max_samples});
  antialiasing_.grid = std::clamp(static_cast<int>(largest) / std::max(width_, height_), 1, wanted.grid);
  samples_.setZero();
  if (is_plain()) return;
  const int width = antialiasing_.grid * width_, height = antialiasing_.grid * height_;
  const int granted = make(fine_, width, height, antialiasing_.samples, "the fine picture");
  antialiasing_.samples = std::min(granted, max_samples);
  for (int i = 0; i < antialiasing_.samples && granted > 1; ++i) {
    float spot[2] = {0.5f, 0.5f};
    glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), spot);
    samples_.col(i) << spot[0] - 0.5f, spot[1] - 0.5f, 0.0f, 0.0f;
  }
  if (granted > 1 && antialiasing_.grid > 1) make(wide_, width, height, 1, "the resolved fine picture");
}

void PictureTarget::bind_plain() const {
  glBindFramebuffer(GL_FRAMEBUFFER, plain_.target.id());
  glViewport(0, 0, width_, height_);
}

void PictureTarget::bind_fine() const {
  glBindFramebuffer(GL_FRAMEBUFFER, is_plain() ? plain_.target.id() : fine_.target.id());
  glViewport(0, 0, antialiasing_.grid * width_, antialiasing_.grid * height_);
}

void PictureTarget::clip_plain(const PixelBox& box) const { glScissor(box.x, box.y, box.width, box.height); }

void PictureTarget::clip_fine(const PixelBox& box) const {
  const int grid = antialiasing_.grid;
  glScissor(grid * box.x, grid * box.y, grid * box.width, grid * box.height);
}

void PictureTarget::resolve(const PixelBox& box) const {
  if (is_plain()) return;
  const int right = box.x + box.width, top = box.y + box.height, grid = antialiasing_.grid;
  const bool both = antialiasing_.samples > 1 && grid > 1;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, fine_.target.id());
  if (both) {  // a blit either resolves or shrinks
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, wide_.target.id());
    glBlitFramebuffer(grid * box.x, grid * box.y, grid * right, grid * top, grid * box.x, grid * box.y,
                      grid * right, grid * top, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, wide_.target.id());
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, plain_.target.id());
  // Between the four, so that each counts as much.
  glBlitFramebuffer(grid * box.x, grid * box.y, grid * right, grid * top, box.x, box.y, right, top,
                    GL_COLOR_BUFFER_BIT, grid > 1 ? GL_LINEAR : GL_NEAREST);
}

Image PictureTarget::read() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, plain_.target.id());
  Image image;
  image.width = width_;
  image.height = height_;
  const std::size_t row = 4 * static_cast<std::size_t>(width_);
  image.rgba.resize(row * static_cast<std::size_t>(height_));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  gl::check_errors("drawing a frame");
  // OpenGL counts rows from below.
  for (std::size_t low = 0, high = image.rgba.size() - row; low < high; low += row, high -= row)
    std::swap_ranges(image.rgba.begin() + static_cast<std::ptrdiff_t>(low),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(low + row),
                     image.rgba.begin() + static_cast<std::ptrdiff_t>(high));
  return image;
}

}  // namespace deforma
