#include "render/pass_clock.hpp"

namespace deforma {
namespace {

std::int64_t now() {
  GLint64 nanoseconds = 0;
  glGetInteger64v(GL_TIMESTAMP, &nanoseconds);
  return nanoseconds;
}

}  // namespace

PassClock::PassClock() {
  GLint bits = 0;
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  works_ = bits > 0;
}

void PassClock::begin_frame() {
  has_shadow_ = false;
  begin_ = now();
}
void PassClock::end_upload() { uploaded_ = now(); }
void PassClock::end_shadow() {
  has_shadow_ = true;
  glQueryCounter(marks_[0].id(), GL_TIMESTAMP);
}
void PassClock::end_shading() { glQueryCounter(marks_[1].id(), GL_TIMESTAMP); }
void PassClock::end_resolve() { glQueryCounter(marks_[2].id(), GL_TIMESTAMP); }

void PassClock::end_frame(DrawingCost& cost) {
  ++cost.frames;
  if (!works_) return;
  std::int64_t before = uploaded_;
  cost.upload += 1e-9 * static_cast<double>(uploaded_ - begin_);
  double* const parts[] = {&cost.shadow, &cost.shading, &cost.resolve};
  for (std::size_t pass = has_shadow_ ? 0 : 1; pass < marks_.size(); ++pass) {
    GLint64 done = 0;
    glGetQueryObjecti64v(marks_[pass].id(), GL_QUERY_RESULT, &done);
    *parts[pass] += 1e-9 * static_cast<double>(done - before);
    before = done;
  }
  cost.readback += 1e-9 * static_cast<double>(now() - before);
}

}  // namespace deforma
