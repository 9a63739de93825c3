// An EGL vendor, as libglvnd loads it, with one device: a graphics card that the driver lists and then cannot open, as
// when its render node may not be read. Source of the interface: glvnd/libeglabi.h.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <glvnd/libeglabi.h>

#include <cstring>

namespace {

int card = 0;  // its address is what the device and its display are known by

EGLBoolean query_devices(EGLint room, EGLDeviceEXT* devices, EGLint* count) {
  if (devices && room > 0) *devices = &card;
  *count = 1;
  return EGL_TRUE;
}

const char* query_device_string(EGLDeviceEXT, EGLint name) {
  return name == EGL_DRM_DEVICE_FILE_EXT ? "/dev/dri/card9" : "EGL_EXT_device_drm";
}

const char* query_string(EGLDisplay, EGLint) {
  return "EGL_EXT_device_base EGL_EXT_device_enumeration EGL_EXT_device_query EGL_EXT_platform_base "
         "EGL_EXT_platform_device";
}

EGLint error() { return EGL_NOT_INITIALIZED; }

EGLBoolean refuse() { return EGL_FALSE; }

template <typename Function>
void* address(Function function) {
  return reinterpret_cast<void*>(function);
}

void* proc_address(const char* name) {
  if (std::strcmp(name, "eglQueryDevicesEXT") == 0) return address(&query_devices);
  if (std::strcmp(name, "eglQueryDeviceStringEXT") == 0) return address(&query_device_string);
  if (std::strcmp(name, "eglQueryString") == 0) return address(&query_string);
  if (std::strcmp(name, "eglGetError") == 0) return address(&error);
  return address(&refuse);
}

EGLDisplay platform_display(EGLenum platform, void* native, const EGLAttrib*) {
  return platform == EGL_PLATFORM_DEVICE_EXT && native == &card ? &card : EGL_NO_DISPLAY;
}

EGLBoolean supports(EGLenum api) { return api == EGL_OPENGL_API; }

const char* vendor_string(int name) {
  return name == __EGL_VENDOR_STRING_PLATFORM_EXTENSIONS ? "EGL_EXT_platform_device" : nullptr;
}

void* dispatch_address(const char*) { return nullptr; }

void set_dispatch_index(const char*, int) {}

}  // namespace

extern "C" EGLBoolean __egl_Main(uint32_t version, const __EGLapiExports*, __EGLvendorInfo*,
                                 __EGLapiImports* imports) {
  if (EGL_VENDOR_ABI_GET_MAJOR_VERSION(version) != EGL_VENDOR_ABI_MAJOR_VERSION) return EGL_FALSE;
  imports->getPlatformDisplay = platform_display;
  imports->getSupportsAPI = supports;
  imports->getVendorString = vendor_string;
  imports->getProcAddress = proc_address;
  imports->getDispatchAddress = dispatch_address;
  imports->setDispatchIndex = set_dispatch_index;
  return EGL_TRUE;
}
