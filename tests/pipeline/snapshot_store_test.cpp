#include "pipeline/snapshot_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include "tests/pipeline/scratch.hpp"

namespace deforma {
namespace {

TEST(SnapshotStore, GivesBackWhatItWasGivenInOrderAndLeavesNoFile) {
  Scratch scratch;
  SnapshotStore store(scratch.path());
  for (int frame = 1; frame <= 3; ++frame) {
    Snapshot snapshot{frame, 0.04 * frame, {}, {}, {}, {}};
    snapshot.points.assign(static_cast<std::size_t>(10 * frame), Vec3(frame, 0.1, -2));
    snapshot.point_values.assign(snapshot.points.size(), 0.5f * static_cast<float>(frame));
    if (frame == 2) snapshot.particles.assign(4, Vec3(1, 2, 3));
    if (frame == 2) snapshot.particle_values.assign(4, 7.0f);
    store.push(snapshot);
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  for (int frame = 1; frame <= 3; ++frame) {
    const std::optional<Snapshot> snapshot = store.pop();
    ASSERT_TRUE(snapshot);
    EXPECT_EQ(snapshot->frame, frame);
    EXPECT_EQ(snapshot->time, 0.04 * frame);
    EXPECT_EQ(snapshot->points,
              std::vector<Vec3>(static_cast<std::size_t>(10 * frame), Vec3(frame, 0.1, -2)));
    EXPECT_EQ(snapshot->point_values,
              std::vector<float>(static_cast<std::size_t>(10 * frame), 0.5f * static_cast<float>(frame)));
    EXPECT_EQ(snapshot->particles.size(), frame == 2 ? 4u : 0u);
    EXPECT_EQ(snapshot->particle_values.size(), frame == 2 ? 4u : 0u);
  }
  EXPECT_FALSE(store.pop());
  EXPECT_THROW(store.push({}), std::logic_error);
}

TEST(SnapshotStore, AFolderThatIsNotThereIsNamed) {
  Scratch scratch;
  EXPECT_THAT([&] { SnapshotStore store(scratch / "none"); },
              testing::ThrowsMessage<std::runtime_error>(
                  testing::AllOf(testing::HasSubstr("none: the frames cannot be kept"),
                                 testing::HasSubstr("No such file or directory"))));
}

TEST(SnapshotStore, AFullDiskIsToldNotPassedOver) {
  Scratch scratch;
  SnapshotStore store(scratch.path());
  // As much as the file size limit of a shell would allow stands for the room on a disk.
  Snapshot large;
  large.points.assign(100000, Vec3::Zero());
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  rlimit small{1 << 20, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  signal(SIGXFSZ, SIG_IGN);
  EXPECT_THAT(
      [&] {
        for (int i = 0; i < 2; ++i) store.push(large);
      },
      testing::ThrowsMessage<std::runtime_error>(
          testing::HasSubstr("cannot be kept until all are simulated")));
  setrlimit(RLIMIT_FSIZE, &old);
  signal(SIGXFSZ, SIG_DFL);
}

}  // namespace
}  // namespace deforma
