#include "sim/neighborhood.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "fixtures.hpp"
#include "sim/morton_order.hpp"

namespace deforma {
namespace {

TEST(Neighborhood, LinksExactlyThePairsWithinTheMeanSupport) {
  State state = lattice_box(Vec3(0.5, 0.4, 0.3), 5, 4, 3, 1000.0, 0.3);
  const Neighborhood& links = state.links;
  for (std::size_t i = 0; i < state.size(); ++i) {
    Range row = links.row(i);
    for (std::size_t j = 0; j < state.size(); ++j) {
      double r = (state.particles.rest[j] - state.particles.rest[i]).norm();
      bool near = j != i && r < 0.5 * (links.support[i] + links.support[j]);
      bool linked = std::any_of(links.links.begin() + row.begin, links.links.begin() + row.end,
                                [&](const Link& link) { return link.j == j; });
      EXPECT_EQ(linked, near) << i << " " << j;
    }
  }
}

TEST(Neighborhood, GivesBothDirectionsExactlyOppositeVectors) {
  State state = lattice_box(Vec3::Constant(0.5), 5, 5, 5, 1000.0, 0.3);
  const Neighborhood& links = state.links;
  for (Index i = 0; i < state.size(); ++i)
    for (Index l = links.row(i).begin; l < links.row(i).end; ++l) {
      Index j = links.links[l].j;
      Range back = links.row(j);
      auto found = std::find_if(links.links.begin() + back.begin, links.links.begin() + back.end,
                                [&](const Link& link) { return link.j == i; });
      ASSERT_NE(found, links.links.begin() + back.end);
      EXPECT_EQ(links.vector(j, *found), -links.vector(i, links.links[l]));
      EXPECT_EQ(found->weight, links.links[l].weight);
    }
}

// Looked up for groups of neighbours or one by one: what is found must be the same.
TEST(Neighborhood, TakesSupportsFromTheNearestInAnyOrderOfTheParticles) {
  constexpr std::size_t k = 18;
  for (double jitter : {0.0, 0.4}) {
    State state = lattice_particles(Vec3(1.1, 1.0, 0.9), 11, 10, 9, 1000.0, jitter);
    const std::vector<Vec3> rest = state.particles.rest;
    std::vector<double> expected;
    for (const Vec3& from : rest) {
      std::vector<double> distance;
      for (const Vec3& to : rest) distance.push_back((to - from).norm());
      std::sort(distance.begin(), distance.end());
      expected.push_back(1.5 * std::accumulate(distance.begin(), distance.begin() + k + 1, 0.0) / k);
    }
    const Neighborhood plain = build_neighborhood(state.particles, state.bodies, {.neighbors = k});
    std::vector<Index> order = morton_order(rest), shuffled = order;
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
    for (const std::vector<Index>& one : {order, shuffled}) {
      for (std::size_t i = 0; i < one.size(); ++i) state.particles.rest[i] = rest[one[i]];
      const Neighborhood links = build_neighborhood(state.particles, state.bodies, {.neighbors = k});
      EXPECT_EQ(links.links.size(), plain.links.size());
      for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_NEAR(plain.support[one[i]], expected[one[i]], 1e-14);
        EXPECT_EQ(links.support[i], plain.support[one[i]]);
        std::vector<Index> row, same;
        for (Index l = links.row(i).begin; l < links.row(i).end; ++l) row.push_back(one[links.links[l].j]);
        for (Index l = plain.row(one[i]).begin; l < plain.row(one[i]).end; ++l)
          same.push_back(plain.links[l].j);
        EXPECT_THAT(row, testing::UnorderedElementsAreArray(same));
      }
    }
  }
}

TEST(Neighborhood, HasTwentySixLinksInsideALattice) {
  State state = lattice_box(Vec3::Constant(0.7), 7, 7, 7, 1000.0);
  EXPECT_EQ(state.links.row(3 * 49 + 3 * 7 + 3).size(), 26u);
}

TEST(Neighborhood, NeverLinksTwoBodies) {
  State state = lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0);
  append_body(state, lattice_particles(Vec3::Constant(0.3), 3, 3, 3, 1000.0), Vec3(0.3, 0, 0));
  prepare_state(state, {});
  for (Index i = 0; i < state.size(); ++i)
    for (Index l = state.links.row(i).begin; l < state.links.row(i).end; ++l)
      EXPECT_EQ(state.particles.body[i], state.particles.body[state.links.links[l].j]);
}

TEST(Neighborhood, AsksTheFilterAboutEveryPair) {
  State state = lattice_particles(Vec3(0.6, 0.2, 0.2), 6, 2, 2, 1000.0);
  append_body(state, lattice_particles(Vec3(0.6, 0.2, 0.2), 6, 2, 2, 1000.0), Vec3::Zero());
  auto same_side = [](const Vec3& a, const Vec3& b) { return (a.x() < 0.3) == (b.x() < 0.3); };
  prepare_state(state, {},
                [&](Index body, const Vec3& a, const Vec3& b) { return body == 0 || same_side(a, b); });
  std::size_t across[2] = {0, 0};
  for (Index i = 0; i < state.size(); ++i)
    for (Index l = state.links.row(i).begin; l < state.links.row(i).end; ++l)
      across[state.particles.body[i]] +=
          !same_side(state.particles.rest[i], state.particles.rest[state.links.links[l].j]);
  EXPECT_GT(across[0], 0u);
  EXPECT_EQ(across[1], 0u);
}

TEST(Neighborhood, ClipsTheCountInTinyBodies) {
  for (int n : {1, 2, 3}) {
    State state = lattice_box(Vec3(0.1 * n, 0.1, 0.1), n, 1, 1, 1000.0);
    EXPECT_EQ(state.links.size(), static_cast<std::size_t>(n));
    EXPECT_EQ(state.links.links.empty(), n == 1);
  }
}

// What a row gathers from for the first time was named by one not far above it, and small bodies need none of it.
TEST(Neighborhood, NamesAheadWhatRowsWillGatherFrom) {
  EXPECT_TRUE(lattice_box(Vec3::Ones(), 10, 10, 10, 1000.0).links.ahead.empty());
  const Neighborhood links = lattice_box(Vec3::Ones(), 20, 20, 15, 1000.0).links;
  ASSERT_EQ(links.ahead.size(), 6000u);
  std::vector<Index> named(links.size(), 0);
  std::vector<std::uint8_t> seen(links.size(), 0);
  std::size_t first = 0, foreseen = 0;
  for (Index i = 0; i < links.size(); ++i) {
    for (Index l = links.start[i]; l < links.start[i + 1]; ++l) {
      const Index j = links.links[l].j;
      if (seen[j]) continue;
      seen[j] = 1;
      ++first;
      if (named[j] > 0 && i + 1 - named[j] <= 200) ++foreseen;
    }
    for (Index j : links.ahead[i].j) {
      ASSERT_LT(j, links.size());
      named[j] = i + 1;
    }
  }
  EXPECT_EQ(first, links.size());
  EXPECT_GT(foreseen, 9 * first / 10);
}

TEST(Neighborhood, RefusesBadSettingsAndPositions) {
  State state = lattice_particles(Vec3::Ones(), 3, 3, 3, 1000.0);
  auto message = [&](const NeighborhoodSettings& settings) -> std::string {
    try {
      build_neighborhood(state.particles, state.bodies, settings);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message({.neighbors = 2}), testing::HasSubstr("at least 3, found 2"));
  EXPECT_THAT(message({.support = -1.0}), testing::HasSubstr("support must be positive"));
  EXPECT_THAT(message({.support = std::nan("")}), testing::HasSubstr("support must be positive"));
  state.particles.rest[4].y() = std::nan("");
  EXPECT_THAT(message({}), testing::HasSubstr("particle 4"));
}

}  // namespace
}  // namespace deforma
