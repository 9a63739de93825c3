#include "render/context.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <stdexcept>

#include "picture.hpp"

namespace deforma {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Context, NeedsNoDisplayServerAndNoHome) {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR", "HOME"}) unsetenv(name);
  const Context context;
  EXPECT_FALSE(context.facts().renderer.empty());
  EXPECT_FALSE(context.facts().version.empty());
  EXPECT_FALSE(context.facts().platform.empty());
}

TEST(Context, IgnoresADisplayThatIsNotThere) {
  setenv("DISPLAY", ":4711", 1);
  setenv("WAYLAND_DISPLAY", "nobody", 1);
  EXPECT_NO_THROW(Context());
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
}

TEST(Context, TakesTheNamedPlatformOnly) {
  const Context any;
  const Context again(ContextRequest{any.facts().platform});
  EXPECT_EQ(again.facts().platform, any.facts().platform);
  EXPECT_TRUE(again.facts().attempts.empty());
  EXPECT_EQ(Context(ContextRequest{"surfaceless"}).facts().platform, "surfaceless");
}

TEST(Context, RefusesAnUnknownPlatform) {
  for (const char* name : {"windows", "", "device:", "device:x", "device:-1", "device:1x"})
    EXPECT_THAT(
        [&] { Context context(ContextRequest{name}); },
        ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(std::string("'") + name + "'"),
                                                   HasSubstr("auto, device:N"), HasSubstr("surfaceless"))))
        << name;
}

TEST(Context, SaysHowManyDevicesThereAre) {
  EXPECT_THAT([] { Context context(ContextRequest{"device:4711"}); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("'device:4711'"), HasSubstr("EGL lists"), HasSubstr("surfaceless"))));
}

TEST(Context, LivesBesideAnother) {
  const Context first;
  {
    const Context second;
    second.make_current();
  }
  EXPECT_NO_THROW(first.make_current());
}

/// EGL reads its vendors when it is loaded, so this needs a process that has not loaded it yet.
TEST(ContextDeathTest, ListsEveryAttemptWithoutADriver) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere/none.json", 1);
        try {
          const Context context;
        } catch (const std::runtime_error& error) {
          std::fprintf(stderr, "%s", error.what());
          std::exit(7);
        }
        std::exit(0);
      },
      testing::ExitedWithCode(7),
      AllOf(HasSubstr("device"), HasSubstr("surfaceless: "), HasSubstr("default: ")));
}

TEST(ContextDeathTest, DrawsWhereTooWideVectorsAreAskedFor) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("LP_NATIVE_VECTOR_WIDTH", "512", 1);
        RendererSettings settings;
        settings.width = settings.height = 64;
        const DrawnGround ground;
        FrameContent frame;
        frame.ground = &ground;
        std::exit(Renderer(settings).draw(frame).width == 64 ? 7 : 0);
      },
      testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace deforma
