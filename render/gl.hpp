#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <string>
#include <utility>

/// OpenGL objects that delete themselves. Each needs the context that made it to be current, at its end too.
namespace deforma::gl {

/// Owns one object name; `Kind` says how to make and delete it.
template <class Kind>
class Object {
 public:
  template <class... Arguments>
  explicit Object(Arguments... arguments) : id_(Kind::make(arguments...)) {}
  ~Object() {
    if (id_ != 0) Kind::drop(id_);
  }
  Object(Object&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

struct BufferKind {
  static GLuint make();
  static void drop(GLuint id);
};
struct VertexArrayKind {
  static GLuint make();
  static void drop(GLuint id);
};
/// Clamped to the edge and linearly filtered, without mipmaps, until told otherwise.
struct TextureKind {
  static GLuint make(GLenum target);
  static void drop(GLuint id);
};
struct SamplerKind {
  static GLuint make();
  static void drop(GLuint id);
};
struct RenderbufferKind {
  static GLuint make();
  static void drop(GLuint id);
};
struct QueryKind {
  static GLuint make();
  static void drop(GLuint id);
};
struct FramebufferKind {
  static GLuint make();
  static void drop(GLuint id);
};

using Buffer = Object<BufferKind>;
using VertexArray = Object<VertexArrayKind>;
using Texture = Object<TextureKind>;
using Sampler = Object<SamplerKind>;
using Renderbuffer = Object<RenderbufferKind>;
using Query = Object<QueryKind>;
using Framebuffer = Object<FramebufferKind>;

/// A linked vertex and fragment shader.
class Program {
 public:
  /// @param name for messages
  /// @throws std::runtime_error with the name and the driver's log.
  Program(const std::string& name, const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(Program&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Program& operator=(Program&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  GLuint id() const { return id_; }
  /// Location of a uniform; -1, which OpenGL ignores, when the compiler found it unused.
  GLint at(const char* uniform) const { return glGetUniformLocation(id_, uniform); }
  /// Connects a uniform block or a sampler to its fixed place.
  void bind_block(const char* block, GLuint place) const;
  void bind_sampler(const char* uniform, GLint unit) const;

 private:
  GLuint id_ = 0;
};

/// @throws std::runtime_error naming `what` when the bound framebuffer is not complete.
void check_framebuffer(const std::string& what);

/// @throws std::runtime_error naming `what` when OpenGL has recorded an error.
void check_errors(const std::string& what);

}  // namespace deforma::gl
