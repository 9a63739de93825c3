#include "render/context.hpp"

// The X11 headers that EGL would pull in define macros such as None and Success.
#define EGL_NO_X11
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "render/gl.hpp"

namespace deforma {
namespace {

std::string error_name(EGLint error) {
  switch (error) {
    case EGL_SUCCESS:
      return "EGL_SUCCESS";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_CURRENT_SURFACE:
      return "EGL_BAD_CURRENT_SURFACE";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_NATIVE_PIXMAP:
      return "EGL_BAD_NATIVE_PIXMAP";
    case EGL_BAD_NATIVE_WINDOW:
      return "EGL_BAD_NATIVE_WINDOW";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    case EGL_BAD_SURFACE:
      return "EGL_BAD_SURFACE";
    case EGL_CONTEXT_LOST:
      return "EGL_CONTEXT_LOST";
    case EGL_BAD_DEVICE_EXT:
      return "EGL_BAD_DEVICE_EXT";
    default:
      return fmt::format("EGL error {:#06x}", error);
  }
}

[[noreturn]] void fail(const char* step) {
  throw std::runtime_error(fmt::format("{} failed with {}", step, error_name(eglGetError())));
}

/// llvmpipe of Mesa 22 crashes in its first draw with vectors of 512 bits. Left alone it takes 256, also where the processor
/// has more; so the environment is touched only where somebody has asked for too much, before the driver reads it, and
/// once, for setenv may not run beside itself. The picture is the same with any width.
void keep_vectors_narrow() {
  static std::once_flag once;
  std::call_once(once, [] {
    const char* wanted = std::getenv("LP_NATIVE_VECTOR_WIDTH");
    if (wanted && std::atoi(wanted) > 256) setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);
  });
}

/// A display and a context on it; destroys the context. The display stays initialised: EGL hands the same one
/// to every caller of the process, so to terminate it here would take it from another context.
class Link {
 public:
  explicit Link(EGLDisplay display) : display_(display) {}
  ~Link() {
    if (context_ == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context_)
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  void create() {
    EGLint major = 0, minor = 0;
    if (!eglInitialize(display_, &major, &minor)) fail("eglInitialize");
    if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI(EGL_OPENGL_API)");
    if (!epoxy_has_egl_extension(display_, "EGL_KHR_surfaceless_context"))
      throw std::runtime_error("EGL_KHR_surfaceless_context is not offered");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count)) fail("eglChooseConfig");
    if (count < 1) throw std::runtime_error("eglChooseConfig offers no configuration for OpenGL");
    for (const auto& [gl_major, gl_minor] : {std::pair{4, 5}, {4, 3}, {4, 1}, {4, 0}, {3, 3}}) {
      const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   gl_major,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   gl_minor,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
      context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, attributes);
      if (context_ != EGL_NO_CONTEXT) break;
    }
    if (context_ == EGL_NO_CONTEXT) fail("eglCreateContext for OpenGL 4.5 down to 3.3 core");
    make_current();
  }

  void make_current() const {
    // The API is bound per thread, and this may be another thread than the one that created the context.
    if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI(EGL_OPENGL_API)");
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      fail("eglMakeCurrent without a surface");
  }

 private:
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

std::string gl_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  if (!text) throw std::runtime_error("glGetString answers nothing");
  return text;
}

/// A context that was made may still draw nothing: clear a small picture and look at a pixel.
void draw_one_pixel() {
  const gl::Texture color(GL_TEXTURE_2D);
  glBindTexture(GL_TEXTURE_2D, color.id());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  const gl::Framebuffer target;
  glBindFramebuffer(GL_FRAMEBUFFER, target.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color.id(), 0);
  gl::check_framebuffer("the trial picture");
  glClearColor(1.0f, 0.0f, 1.0f, 1.0f);
  glClear(GL_COLOR_BUFFER_BIT);
  std::uint8_t pixel[4] = {};
  glReadPixels(1, 1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (pixel[0] != 255 || pixel[1] != 0 || pixel[2] != 255 || pixel[3] != 255)
    throw std::runtime_error(fmt::format("a cleared pixel reads back as {} {} {} {} instead of 255 0 255 255",
                                         pixel[0], pixel[1], pixel[2], pixel[3]));
}

template <class Function>
Function client_function(const char* name) {
  // Asked for by name: libepoxy ends the program when a function is missing.
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool client_has(const char* extension) { return epoxy_has_egl_extension(EGL_NO_DISPLAY, extension); }

std::vector<EGLDeviceEXT> list_devices() {
  if (!client_has("EGL_EXT_device_enumeration") && !client_has("EGL_EXT_device_base")) return {};
  const auto query = client_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  EGLint count = 0;
  if (!query || !query(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (!query(count, devices.data(), &count)) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

EGLDisplay platform_display(EGLenum platform, void* native, const char* extension) {
  if (!client_has("EGL_EXT_platform_base") || !client_has(extension))
    throw std::runtime_error(fmt::format("{} is not offered", extension));
  const auto get = client_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (!get) throw std::runtime_error("eglGetPlatformDisplayEXT is missing");
  const EGLDisplay display = get(platform, native, nullptr);
  if (display == EGL_NO_DISPLAY) fail("eglGetPlatformDisplayEXT");
  return display;
}

/// "device:0 (/dev/dri/card0)"; what draws in software has no file.
std::string device_name(std::size_t number, EGLDeviceEXT device) {
  const auto query = client_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  const char* file = query ? query(device, EGL_DRM_DEVICE_FILE_EXT) : nullptr;
  if (!file) eglGetError();  // that it has no file is no error of what follows
  return file ? fmt::format("device:{} ({})", number, file) : fmt::format("device:{}", number);
}

std::string no_such_device(const std::string& platform, const std::vector<EGLDeviceEXT>& devices) {
  std::vector<std::string> present;
  for (std::size_t number = 0; number < devices.size(); ++number)
    present.push_back(device_name(number, devices[number]));
  return fmt::format(
      "there is no rendering platform '{}'; EGL lists {} device{}{}{}; auto, surfaceless and "
      "default need none",
      platform, devices.size(), devices.size() == 1 ? "" : "s", devices.empty() ? "" : ": ",
      fmt::join(present, ", "));
}

/// What the environment says to the driver and may be why nothing works, as a line each.
std::string suspicious_environment() {
  std::string lines;
  for (const char* name :
       {"__EGL_VENDOR_LIBRARY_FILENAMES", "__EGL_VENDOR_LIBRARY_DIRS", "MESA_GL_VERSION_OVERRIDE",
        "MESA_GLSL_VERSION_OVERRIDE", "MESA_LOADER_DRIVER_OVERRIDE", "GALLIUM_DRIVER", "LIBGL_DRIVERS_PATH",
        "LIBGL_ALWAYS_SOFTWARE", "EGL_PLATFORM"})
    if (const char* value = std::getenv(name)) lines += fmt::format("\n  {}={}", name, value);
  return lines.empty() ? "" : "\nThe environment may be the cause; without these it may work:" + lines;
}

/// The number N of "device:N"; nothing for another form.
std::optional<std::size_t> device_number(const std::string& platform) {
  constexpr std::string_view prefix = "device:";
  if (!platform.starts_with(prefix)) return std::nullopt;
  std::size_t number = 0;
  const char* end = platform.data() + platform.size();
  const auto [rest, error] = std::from_chars(platform.data() + prefix.size(), end, number);
  if (error != std::errc{} || rest != end) return std::nullopt;
  return number;
}

}  // namespace

struct Context::Data {
  std::unique_ptr<Link> link;
  ContextFacts facts;

  template <class Open>
  bool attempt(const std::string& platform, Open open, const std::string& described = "") {
    try {
      auto candidate = std::make_unique<Link>(open());
      candidate->create();
      facts.vendor = gl_string(GL_VENDOR);
      facts.renderer = gl_string(GL_RENDERER);
      facts.version = gl_string(GL_VERSION);
      draw_one_pixel();
      link = std::move(candidate);
      facts.platform = platform;
      return true;
    } catch (const std::runtime_error& error) {
      facts.attempts.push_back(fmt::format("{}: {}", described.empty() ? platform : described, error.what()));
      return false;
    }
  }

  bool attempt_device(std::size_t number, EGLDeviceEXT device) {
    return attempt(
        fmt::format("device:{}", number),
        [&] { return platform_display(EGL_PLATFORM_DEVICE_EXT, device, "EGL_EXT_platform_device"); },
        device_name(number, device));
  }

  bool attempt_surfaceless() {
    return attempt("surfaceless", [] {
      return platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, "EGL_MESA_platform_surfaceless");
    });
  }

  bool attempt_default() {
    return attempt("default", [] {
      const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
      if (display == EGL_NO_DISPLAY) fail("eglGetDisplay(EGL_DEFAULT_DISPLAY)");
      return display;
    });
  }

  bool attempt_all() {
    const auto devices = list_devices();
    if (devices.empty()) facts.attempts.emplace_back("device: EGL lists none");
    for (std::size_t number = 0; number < devices.size(); ++number)
      if (attempt_device(number, devices[number])) return true;
    return attempt_surfaceless() || attempt_default();
  }
};

Context::Context(const ContextRequest& request) : data_(std::make_unique<Data>()) {
  const auto number = device_number(request.platform);
  if (!number && request.platform != "auto" && request.platform != "surfaceless" &&
      request.platform != "default")
    throw std::invalid_argument(fmt::format(
        "unknown rendering platform '{}'; allowed are auto, device:N (N = 0, 1, ...), surfaceless, default",
        request.platform));
  keep_vectors_narrow();
  if (!epoxy_has_egl())
    throw std::runtime_error("no OpenGL context: the EGL library (libEGL.so.1) is not installed");
  bool made = false;
  if (number) {
    const auto devices = list_devices();
    if (*number >= devices.size()) throw std::invalid_argument(no_such_device(request.platform, devices));
    made = data_->attempt_device(*number, devices[*number]);
  } else if (request.platform == "surfaceless") {
    made = data_->attempt_surfaceless();
  } else if (request.platform == "default") {
    made = data_->attempt_default();
  } else {
    made = data_->attempt_all();
  }
  if (!made)
    throw std::runtime_error(
        fmt::format("no OpenGL context can be had; tried\n  {}\nIs a driver installed (Debian: "
                    "libegl-mesa0 and libgl1-mesa-dri)?{}",
                    fmt::join(data_->facts.attempts, "\n  "), suspicious_environment()));
}

std::vector<ContextFacts> Context::try_all() {
  keep_vectors_narrow();
  std::vector<ContextFacts> trials;
  if (!epoxy_has_egl()) return trials;
  const auto add = [&](const std::string& name, auto attempt) {
    Data data;
    attempt(data);
    data.facts.platform = name;
    trials.push_back(std::move(data.facts));
  };
  const auto devices = list_devices();
  for (std::size_t number = 0; number < devices.size(); ++number)
    add(device_name(number, devices[number]),
        [&](Data& data) { data.attempt_device(number, devices[number]); });
  add("surfaceless", [](Data& data) { data.attempt_surfaceless(); });
  add("default", [](Data& data) { data.attempt_default(); });
  return trials;
}

Context::~Context() = default;

const ContextFacts& Context::facts() const { return data_->facts; }

void Context::make_current() const { data_->link->make_current(); }

}  // namespace deforma
