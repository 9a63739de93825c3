#include "render/gl.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace deforma::gl {
namespace {

GLuint compile(const std::string& name, GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint done = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == GL_TRUE) return shader;
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  glDeleteShader(shader);
  throw std::runtime_error(fmt::format("the {} shader '{}' does not compile: {}",
                                       stage == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log.c_str()));
}

}  // namespace

GLuint BufferKind::make() {
  GLuint id = 0;
  glGenBuffers(1, &id);
  return id;
}
void BufferKind::drop(GLuint id) { glDeleteBuffers(1, &id); }

GLuint VertexArrayKind::make() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return id;
}
void VertexArrayKind::drop(GLuint id) { glDeleteVertexArrays(1, &id); }

GLuint TextureKind::make(GLenum target) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(target, id);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return id;
}
void TextureKind::drop(GLuint id) { glDeleteTextures(1, &id); }

GLuint SamplerKind::make() {
  GLuint id = 0;
  glGenSamplers(1, &id);
  return id;
}
void SamplerKind::drop(GLuint id) { glDeleteSamplers(1, &id); }

GLuint RenderbufferKind::make() {
  GLuint id = 0;
  glGenRenderbuffers(1, &id);
  return id;
}
void RenderbufferKind::drop(GLuint id) { glDeleteRenderbuffers(1, &id); }

GLuint QueryKind::make() {
  GLuint id = 0;
  glGenQueries(1, &id);
  return id;
}
void QueryKind::drop(GLuint id) { glDeleteQueries(1, &id); }

GLuint FramebufferKind::make() {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  return id;
}
void FramebufferKind::drop(GLuint id) { glDeleteFramebuffers(1, &id); }

Program::Program(const std::string& name, const std::string& vertex, const std::string& fragment) {
  const GLuint first = compile(name, GL_VERTEX_SHADER, vertex);
  GLuint second = 0;
  try {
    second = compile(name, GL_FRAGMENT_SHADER, fragment);
  } catch (...) {
    glDeleteShader(first);
    throw;
  }
  id_ = glCreateProgram();
  glAttachShader(id_, first);
  glAttachShader(id_, second);
  glLinkProgram(id_);
  glDeleteShader(first);
  glDeleteShader(second);
  GLint done = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &done);
  if (done == GL_TRUE) return;
  GLint length = 0;
  glGetProgramiv(id_, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<std::size_t>(length), '\0');
  glGetProgramInfoLog(id_, length, nullptr, log.data());
  glDeleteProgram(id_);
  throw std::runtime_error(fmt::format("the shader program '{}' does not link: {}", name, log.c_str()));
}

Program::~Program() {
  if (id_ != 0) glDeleteProgram(id_);
}

void Program::bind_block(const char* block, GLuint place) const {
  const GLuint index = glGetUniformBlockIndex(id_, block);
  if (index != GL_INVALID_INDEX) glUniformBlockBinding(id_, index, place);
}

void Program::bind_sampler(const char* uniform, GLint unit) const {
  glUseProgram(id_);
  glUniform1i(at(uniform), unit);
}

void check_framebuffer(const std::string& what) {
  const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(
        fmt::format("the framebuffer of {} is not complete (status {:#06x})", what, status));
}

void check_errors(const std::string& what) {
  const GLenum error = glGetError();
  if (error != GL_NO_ERROR) throw std::runtime_error(fmt::format("OpenGL error {:#06x} in {}", error, what));
}

}  // namespace deforma::gl
