#include "assets/import.hpp"
#include "assets/sample.hpp"
#include "tests/assets/fixtures.hpp"

namespace deforma {
namespace {

const std::filesystem::path meshes = std::filesystem::path(DEFORMA_SOURCE_DIR) / "assets" / "meshes";

TEST(ShippedMeshes, AreClosedDetailedAndSmall) {
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(meshes)) {
    SCOPED_TRACE(entry.path());
    Imported imported = import_mesh(entry.path());
    MeshFacts facts = inspect(imported.mesh);
    EXPECT_EQ(facts.boundary_edges, 0u);
    EXPECT_EQ(facts.non_manifold_edges, 0u);
    EXPECT_EQ(facts.components, 1u);
    EXPECT_GT(facts.volume, 0.0);
    EXPECT_EQ(imported.dropped_triangles, 0u);
    EXPECT_GT(imported.mesh.points.size(), 3000u);
    EXPECT_LT(std::filesystem::file_size(entry.path()), 500'000u);
    ++found;
  }
  EXPECT_GE(found, 1u);
}

TEST(ShippedMeshes, HopperStandsOneMetreTallAndFillsToTheCount) {
  Mesh hopper = import_mesh(meshes / "hopper.obj").mesh;
  MeshFacts facts = inspect(hopper);
  EXPECT_NEAR(facts.min.z(), 0.0, 1e-4);
  EXPECT_NEAR(facts.max.z(), 1.0, 1e-4);
  EXPECT_NEAR(facts.min.y() + facts.max.y(), 0.0, 1e-4) << "left and right alike";
  Sampling sampling = sample_interior(hopper, {2500, 0.0, Arrangement::lattice});
  EXPECT_EQ(sampling.points.size(), 2500u);
  EXPECT_TRUE(sampling.warnings.empty());
}

}  // namespace
}  // namespace deforma
