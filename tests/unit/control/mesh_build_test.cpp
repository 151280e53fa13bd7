// Meshes from soups: what is mended and said, what is refused with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>

#include "tests/support/meshes.h"

namespace hapticd::control {
namespace {

using namespace test;
using build::make_mesh;
using build::MeshData;
using build::TriangleSoup;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MeshData mesh_of(TriangleSoup soup) {
  auto mesh = make_mesh(std::move(soup));
  if (!mesh) throw std::runtime_error(mesh.error().text);
  return std::move(*mesh);
}

std::string error_of(TriangleSoup soup) {
  const auto mesh = make_mesh(std::move(soup));
  return mesh ? "no error" : mesh.error().text;
}

TEST(MeshBuild, NeighboursShareAnEdgeInOppositeDirections) {
  const MeshData mesh = mesh_of(bumpy_soup(32, 17));
  ASSERT_EQ(mesh.triangles.size(), 1024U);
  for (const MeshTriangle& t : mesh.triangles)
    for (std::size_t e = 0; e < 3; ++e) {
      const MeshTriangle& n = mesh.triangles[t.neighbour[e]];
      bool shared = false;
      for (std::size_t i = 0; i < 3; ++i)
        shared |= n.vertex[i] == t.vertex[(e + 1) % 3] && n.vertex[(i + 1) % 3] == t.vertex[e];
      EXPECT_TRUE(shared);
    }
}

TEST(MeshBuild, TrianglesOfAnStlAreWeldedWithoutAWord) {
  const TriangleSoup cube = cube_soup();
  TriangleSoup apart;
  for (const auto& t : cube.triangles) {
    const auto base = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : t) apart.vertices.push_back(cube.vertices[corner]);
    apart.triangles.push_back({base, base + 1, base + 2});
  }
  const MeshData mesh = mesh_of(apart);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_THAT(mesh.repairs, IsEmpty());
}

TEST(MeshBuild, OnlyASingleSurfaceWithoutConcaveEdgesIsConvex) {
  EXPECT_TRUE(mesh_of(cube_soup()).convex);
  EXPECT_TRUE(mesh_of(sphere_soup(100, 51)).convex);
  EXPECT_FALSE(mesh_of(groove_soup(0.01, 0.1)).convex);
  EXPECT_FALSE(mesh_of(bumpy_soup(100, 51)).convex);
  TriangleSoup two = cube_soup();
  add(two, box_soup({0.06, 0, 0}, {0.07, 0.01, 0.01}));
  EXPECT_FALSE(mesh_of(two).convex);
}

TEST(MeshBuild, FlatAndRepeatedTrianglesAreDroppedAndSaid) {
  TriangleSoup soup = cube_soup();
  soup.triangles.push_back({0, 0, 1});
  soup.triangles.push_back({2, 1, 0});
  const MeshData mesh = mesh_of(soup);
  EXPECT_EQ(mesh.triangles.size(), 12U);
  EXPECT_THAT(mesh.repairs,
              ElementsAre("1 triangle without area dropped", "1 repeated triangle dropped"));
}

TEST(MeshBuild, InsideOutIsTurned) {
  TriangleSoup soup = sphere_soup(32, 17);
  turn_inside_out(soup);
  std::swap(soup.triangles[7][0], soup.triangles[7][1]);
  const MeshData mesh = mesh_of(soup);
  EXPECT_THAT(mesh.repairs, ElementsAre("1023 triangles turned to face outwards"));
  for (const MeshTriangle& t : mesh.triangles) EXPECT_GT(dot(t.normal, t.corner[0]), 0);
}

TEST(MeshBuild, ACavityStaysAsItIs) {
  TriangleSoup soup = cube_soup(0.05);
  TriangleSoup hole = cube_soup(0.02);
  turn_inside_out(hole);
  add(soup, hole);
  const MeshData mesh = mesh_of(soup);
  EXPECT_THAT(mesh.repairs, IsEmpty());
  EXPECT_GT(nearest_surface(mesh.view(), {0.001, 0, 0}, 1).height, 0);  // in the hole: free
  EXPECT_LT(nearest_surface(mesh.view(), {0.035, 0, 0}, 1).height, 0);
}

TEST(MeshBuild, APartBesideAnotherIsTurnedByItself) {
  TriangleSoup soup = cube_soup(0.05);
  TriangleSoup other = box_soup({0.1, 0, 0}, {0.2, 0.1, 0.1});
  turn_inside_out(other);
  add(soup, other);
  EXPECT_THAT(mesh_of(soup).repairs, ElementsAre("12 triangles turned to face outwards"));
}

TEST(MeshBuild, ACornerOfTwoSurfacesIsSplit) {
  TriangleSoup soup = box_soup({0, 0, 0}, {1, 1, 1});
  add(soup, box_soup({1, 1, 1}, {2, 2, 2}));
  const MeshData mesh = mesh_of(soup);
  EXPECT_THAT(mesh.repairs, ElementsAre("1 corner split where surfaces touch"));
}

TEST(MeshBuild, WhatIsNoClosedSurfaceIsRefusedWithItsPlace) {
  TriangleSoup open = cube_soup();
  open.triangles.pop_back();
  EXPECT_THAT(error_of(open), HasSubstr("found 3 open edges, the first from (0.05, "));
  TriangleSoup crowded = cube_soup();
  crowded.vertices.push_back({0, 0, 1});
  crowded.triangles.push_back({0, 1, 8});
  EXPECT_THAT(error_of(crowded), HasSubstr("found 1 edge of more than two, the first from (-0.05"));
}

TEST(MeshBuild, ASurfaceWithOneSideIsRefused) {
  // The projective plane on six vertices.
  TriangleSoup soup;
  soup.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                    {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  EXPECT_THAT(error_of(soup), HasSubstr("single side"));
}

TEST(MeshBuild, WhatIsNoNumberOrNoVertexIsRefused) {
  TriangleSoup soup = cube_soup();
  soup.vertices[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(soup), HasSubstr("as vertex 3"));
  soup = cube_soup();
  soup.triangles[5][1] = 8;
  EXPECT_THAT(error_of(soup), HasSubstr("triangle 5: expected vertices below 8, found 8"));
  EXPECT_THAT(error_of({}), HasSubstr("expected triangles"));
}

}  // namespace
}  // namespace hapticd::control
