// Mesh files: what is in them arrives, what is not a mesh is refused with words, and no bytes at
// all bring the reader down.
#include "config/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/meshes.h"
#include "tests/unit/daemon/temp_dir.h"

namespace hapticd::config {
namespace {

using hapticd::test::TempDir;
using testing::AllOf;
using testing::HasSubstr;

std::string data_path(const std::string& name) {
  return std::string(HAPTICD_SOURCE_DIR) + "/tests/data/meshes/" + name;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string put(const TempDir& dir, const std::string& name, const std::string& bytes) {
  std::ofstream(dir.file(name), std::ios::binary) << bytes;
  return dir.file(name);
}

void append(std::string& bytes, float value) {
  char raw[4];
  std::memcpy(raw, &value, 4);
  bytes.append(raw, 4);
}

std::string binary_stl(const build::TriangleSoup& soup) {
  std::string bytes(80, ' ');
  const auto count = static_cast<std::uint32_t>(soup.triangles.size());
  for (int shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(static_cast<unsigned char>(count >> shift));
  for (const auto& triangle : soup.triangles) {
    for (int i = 0; i < 3; ++i) append(bytes, 0);
    for (const std::uint32_t corner : triangle)
      for (std::size_t i = 0; i < 3; ++i)
        append(bytes, static_cast<float>(soup.vertices[corner][i]));
    bytes.append(2, '\0');
  }
  return bytes;
}

/// Volume that the triangles enclose.
double volume(const build::TriangleSoup& soup) {
  double sum = 0;
  for (const auto& t : soup.triangles)
    sum += dot(soup.vertices[t[0]], cross(soup.vertices[t[1]], soup.vertices[t[2]])) / 6;
  return sum;
}

std::string error_of(const std::string& path, std::size_t most = 1000) {
  const auto read = read_mesh(path, most);
  return read ? "no error" : read.error().text;
}

TEST(MeshFile, AsciiStlArrives) {
  const auto soup = read_mesh(data_path("tetrahedron.stl"), 4);
  ASSERT_TRUE(soup) << soup.error().text;
  EXPECT_EQ(soup->triangles.size(), 4U);
  EXPECT_DOUBLE_EQ(volume(*soup), 1.0 / 6);
}

TEST(MeshFile, BinaryStlArrives) {
  const TempDir dir;
  const auto sphere = hapticd::test::sphere_soup(32, 17);
  const auto soup = read_mesh(put(dir, "a.STL", binary_stl(sphere)), 1024);
  ASSERT_TRUE(soup) << soup.error().text;
  EXPECT_EQ(soup->triangles.size(), 1024U);
  EXPECT_NEAR(volume(*soup), volume(sphere), 1e-6 * volume(sphere));
}

TEST(MeshFile, PolygonsOfAnObjBecomeTriangles) {
  const auto soup = read_mesh(data_path("cube.obj"), 12);
  ASSERT_TRUE(soup) << soup.error().text;
  EXPECT_EQ(soup->triangles.size(), 12U);
  EXPECT_DOUBLE_EQ(volume(*soup), 1);
}

TEST(MeshFile, PlyArrives) {
  const auto soup = read_mesh(data_path("tetrahedron.ply"), 4);
  ASSERT_TRUE(soup) << soup.error().text;
  EXPECT_EQ(soup->triangles.size(), 4U);
  EXPECT_DOUBLE_EQ(volume(*soup), 1.0 / 6);
}

/// A tetrahedron whose vertices have a property more, in either byte order.
std::string binary_ply(bool big) {
  std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double x\n"
                      "property float y\nproperty short z\nelement face 4\n"
                      "property list uint8 uint vertex_index\nend_header\n";
  const auto put_raw = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (big) std::reverse(raw, raw + sizeof value);
    bytes.append(raw, sizeof value);
  };
  for (int i = 0; i < 4; ++i) {
    put_raw(std::uint8_t{200});
    put_raw(i == 1 ? 1.0 : 0.0);
    put_raw(i == 2 ? 1.0F : 0.0F);
    put_raw(static_cast<std::int16_t>(i == 3 ? -300 : 0));
  }
  for (const auto& t : {std::array{0U, 1U, 2U}, {0U, 3U, 1U}, {0U, 2U, 3U}, {1U, 3U, 2U}}) {
    put_raw(std::uint8_t{3});
    for (const std::uint32_t corner : t) put_raw(corner);
  }
  return bytes;
}

TEST(MeshFile, BinaryPlyArrivesInEitherByteOrder) {
  const TempDir dir;
  for (const bool big : {false, true}) {
    const auto soup = read_mesh(put(dir, "b.ply", binary_ply(big)), 4);
    ASSERT_TRUE(soup) << soup.error().text;
    EXPECT_DOUBLE_EQ(volume(*soup), 300.0 / 6);
    EXPECT_EQ(soup->vertices[3], (Vec3{0, 0, -300}));
  }
}

TEST(MeshFile, CornersOfAnObjMayCountBackwardsAndNameLooks) {
  const TempDir dir;
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3/7/8 2//1 +3/1\n";
  const auto soup = read_mesh(put(dir, "a.obj", text), 4);
  ASSERT_TRUE(soup) << soup.error().text;
  EXPECT_EQ(soup->triangles.front(), (std::array{0U, 1U, 2U}));
  EXPECT_THAT(error_of(put(dir, "b.obj", text + "f 1 2 4\n")),
              AllOf(HasSubstr("line 5"), HasSubstr("number 3")));
  EXPECT_THAT(error_of(put(dir, "c.obj", text + "f 1 2 x\n")), HasSubstr("\"f 1 2 x\""));
}

TEST(MeshFile, APolygonThatBendsInwardsIsRefused) {
  const TempDir dir;
  const std::string arrow = "v 0 0 0\nv 2 1 0\nv 0.5 0.5 0\nv 1 2 0\n";
  EXPECT_TRUE(read_mesh(put(dir, "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4"), 4));
  EXPECT_THAT(error_of(put(dir, "b.obj", arrow + "f 2 3 4 1\n")), HasSubstr("bends inwards"));
}

TEST(MeshFile, EveryFormatMakesAMeshThatCanBeWalkedOver) {
  for (const char* name : {"tetrahedron.stl", "cube.obj", "tetrahedron.ply"}) {
    const auto mesh = read_mesh(data_path(name), 100).and_then(build::make_mesh);
    ASSERT_TRUE(mesh) << mesh.error().text;
    EXPECT_TRUE(mesh->repairs.empty()) << name << ": " << mesh->repairs.front();
    EXPECT_TRUE(mesh->convex);
  }
}

TEST(MeshFile, TooManyTrianglesAreRefusedWithBothNumbers) {
  EXPECT_THAT(error_of(data_path("tetrahedron.stl"), 3),
              AllOf(HasSubstr("= 3"), HasSubstr("found 4")));
  EXPECT_THAT(error_of(data_path("tetrahedron.ply"), 3),
              AllOf(HasSubstr("= 3"), HasSubstr("found 4")));
  EXPECT_THAT(error_of(data_path("cube.obj"), 11), AllOf(HasSubstr("= 11"), HasSubstr("found 12")));
}

TEST(MeshFile, AHeaderThatLiesAboutItsLengthIsRefused) {
  const TempDir dir;
  std::string bytes = binary_stl(hapticd::test::cube_soup());
  bytes[82] = '\x7f';
  EXPECT_THAT(error_of(put(dir, "lie.stl", bytes)), AllOf(HasSubstr("lie.stl"), HasSubstr("684")));
  std::string text = text_of(data_path("tetrahedron.ply"));
  text.replace(text.find("face 4"), 6, "face 999");
  EXPECT_THAT(error_of(put(dir, "lie.ply", text)), HasSubstr("999 elements \"face\""));
}

TEST(MeshFile, AFileTooLargeForItsTrianglesIsRefusedUnread) {
  const TempDir dir;
  const std::string path = put(dir, "sparse.obj", "");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40);
  EXPECT_THAT(error_of(path), AllOf(HasSubstr("max_triangles"), HasSubstr("1099511627776")));
}

TEST(MeshFile, WhatIsNotThereOrNoFileIsSaid) {
  const TempDir dir;
  EXPECT_THAT(error_of(dir.file("none.stl")), HasSubstr("none.stl: expected a mesh file"));
  EXPECT_THAT(error_of(dir.path()), HasSubstr("no regular file"));
  EXPECT_THAT(error_of(put(dir, "a.step", "ISO-10303-21;")), HasSubstr(".stl, .obj or .ply"));
  EXPECT_THAT(error_of(put(dir, "b.stl", "")), HasSubstr("expected an STL"));
  EXPECT_THAT(error_of(put(dir, "c.obj", "v 0 0 0\n")), HasSubstr("found none"));
  EXPECT_THAT(error_of(put(dir, "d.ply", "plyers")), HasSubstr("\"ply\""));
  EXPECT_THAT(error_of(put(dir, "e.ply", "ply\nformat ascii 1.0\n")), HasSubstr("end_header"));
  EXPECT_THAT(error_of(put(dir, "f.ply", "ply\ncommemt a\n")), HasSubstr("commemt a"));
}

/// A good file of each kind.
const std::vector<std::pair<std::string, std::string>>& good_files() {
  static const std::vector<std::pair<std::string, std::string>> files{
      {"m.stl", text_of(data_path("tetrahedron.stl"))},
      {"m.stl", binary_stl(hapticd::test::cube_soup())},
      {"m.obj", text_of(data_path("cube.obj"))},
      {"m.ply", text_of(data_path("tetrahedron.ply"))},
      {"m.ply", binary_ply(false)}};
  return files;
}

/// Triangles, at most as many as allowed, or words.
void check_outcome(const std::string& name, const std::string& bytes) {
  static const TempDir dir;
  const auto made = read_mesh(put(dir, name, bytes), 50).and_then(build::make_mesh);
  if (made)
    RC_ASSERT(made->triangles.size() <= 50U);
  else
    RC_ASSERT(made.error().text.size() > 20U);
}

RC_GTEST_PROP(MeshFileProperty, FilesCutShortEndWell, ()) {
  const auto& [name, bytes] = *rc::gen::elementOf(good_files());
  check_outcome(name, bytes.substr(0, *rc::gen::inRange<std::size_t>(0, bytes.size())));
}

RC_GTEST_PROP(MeshFileProperty, FilesWithRandomBytesEndWell, ()) {
  auto [name, bytes] = *rc::gen::elementOf(good_files());
  const int changes = *rc::gen::inRange(1, 10);
  for (int i = 0; i < changes; ++i)
    bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
  check_outcome(name, bytes);
}

RC_GTEST_PROP(MeshFileProperty, FilesWithOtherNumbersEndWell, ()) {
  auto [name, bytes] = *rc::gen::elementOf(good_files());
  const std::vector<std::string> marks{"-1",    "999999999", "4294967296", "nan", "inf",
                                       "1e999", " ",         "\n",         "-",   "/",
                                       "3 3",   "f",         "\"",         "ply"};
  const int changes = *rc::gen::inRange(1, 6);
  for (int i = 0; i < changes; ++i)
    bytes.insert(*rc::gen::inRange<std::size_t>(0, bytes.size()), *rc::gen::elementOf(marks));
  check_outcome(name, bytes);
}

}  // namespace
}  // namespace hapticd::config
