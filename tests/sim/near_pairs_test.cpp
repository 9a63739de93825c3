#include "sim/near_pairs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace deforma {
namespace {

struct Cloud {
  Particles particles;
  std::vector<Index> members;
  std::mt19937 generator{9};

  explicit Cloud(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) particles.rest.push_back(random_point(1.0) + Vec3(1000, -7, 3));
    particles.displacement.assign(count, Vec3::Zero());
    for (Index i = 0; i < count; ++i)
      if (i % 5 != 4) members.push_back(i);
  }
  Vec3 random_point(double reach) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = (generator() / 2147483648.0 - 1.0) * reach;
    return p;
  }
  static bool accepts(Index i, Index j) { return (i + j) % 3 != 0; }

  void expect_every_pair(const NearPairs& pairs, double reach) const {
    std::size_t near = 0;
    for (Index i : members) {
      auto row = pairs.of(i);
      EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
      for (Index j : row) {
        EXPECT_TRUE(accepts(i, j) && i != j && j % 5 != 4);
        EXPECT_THAT(pairs.of(j), testing::Contains(i));
      }
      for (Index j : members) {
        if (i == j || !accepts(i, j) || (particles.position(i) - particles.position(j)).norm() > reach)
          continue;
        EXPECT_THAT(row, testing::Contains(j));
        ++near;
      }
    }
    EXPECT_GT(near, 100u);
  }
};

TEST(NearPairs, ListsEveryPairWithinReach) {
  Cloud cloud(600);
  NearPairs pairs(0.2, 0.05);
  pairs.update(cloud.particles, cloud.members, Cloud::accepts);
  cloud.expect_every_pair(pairs, 0.2);
  EXPECT_TRUE(pairs.of(4).empty());
}

TEST(NearPairs, MissesNoneWhileParticlesWander) {
  Cloud cloud(400);
  NearPairs pairs(0.2, 0.1);
  for (int step = 0; step < 30; ++step) {
    for (Vec3& u : cloud.particles.displacement) u += cloud.random_point(0.01);
    pairs.update(cloud.particles, cloud.members, Cloud::accepts);
    cloud.expect_every_pair(pairs, 0.2);
  }
}

TEST(NearPairs, CopesWithParticlesVeryFarApart) {
  Cloud cloud(300);
  cloud.particles.displacement[0] = Vec3(1e9, 0, 0);
  NearPairs pairs(0.2, 0.05);
  pairs.update(cloud.particles, cloud.members, Cloud::accepts);
  cloud.expect_every_pair(pairs, 0.2);
  EXPECT_TRUE(pairs.of(0).empty());
}

TEST(NearPairs, RefusesANegativeReach) {
  try {
    NearPairs pairs(-1.0, 0.1);
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("found -1 m and 0.1 m"));
  }
}

}  // namespace
}  // namespace deforma
