// Files that cannot be read: the right exit code, and what to do.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

class TempDir {
 public:
  TempDir() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "hapticd_config_XXXXXX").string();
    path = ::mkdtemp(pattern.data());
    std::filesystem::permissions(path, std::filesystem::perms(0755));
  }
  ~TempDir() { std::filesystem::remove_all(path); }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
  std::filesystem::path path;
};

/// Root may read everything, so while this lives root is somebody else.
class NotRoot {
 public:
  NotRoot() { was_root_ = ::geteuid() == 0 && ::seteuid(65534) == 0; }
  ~NotRoot() {
    if (was_root_ && ::seteuid(0) != 0) std::abort();
  }
  NotRoot(const NotRoot&) = delete;
  NotRoot& operator=(const NotRoot&) = delete;

 private:
  bool was_root_ = false;
};

void expect_unreadable(const std::string& path, ExitCode code, const std::string& words) {
  const auto document = read_file(path);
  ASSERT_FALSE(document);
  ASSERT_EQ(document.error().size(), 1U);
  EXPECT_EQ(document.error()[0].code, code);
  EXPECT_EQ(document.error()[0].file, path);
  EXPECT_NE(document.error()[0].message.find(words), std::string::npos)
      << to_string(document.error()[0]);
}

TEST(ConfigFile, IsReadWithItsTextAndDigest) {
  const TempDir dir;
  const std::string path = dir.write("a.yaml", kSmall);
  const auto document = read_file(path);
  ASSERT_TRUE(document);
  EXPECT_EQ(document->path, path);
  EXPECT_EQ(document->text, kSmall);
  EXPECT_EQ(document->config, config_of(kSmall));
}

TEST(ConfigFile, DigestIsFnv1aOfTheText) {
  // Published vector: FNV-1a 64 of "foobar" is 85944171f73967e8; here it stands at the end of a
  // chain that is known.
  const auto a = read_text(kSmall, "f");
  const auto b = read_text(kSmall + "\n", "f");
  ASSERT_TRUE(a && b);
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : std::string("foobar"))
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  ASSERT_EQ(hash, 0x85944171f73967e8ULL);
  hash = 14695981039346656037ULL;
  for (const char c : kSmall) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  EXPECT_EQ(std::stoull(a->digest, nullptr, 16), hash);
  EXPECT_EQ(a->digest.size(), 16U);
  EXPECT_NE(a->digest, b->digest);
}

TEST(ConfigFile, MissingIsNoInput) {
  expect_unreadable("/nonexistent/a.yaml", ExitCode::no_input, "No such file");
}

TEST(ConfigFile, DirectoryIsNoInput) {
  expect_unreadable("/tmp", ExitCode::no_input, "directory");
}

TEST(ConfigFile, ForbiddenIsNoPermission) {
  const TempDir dir;
  const std::string path = dir.write("a.yaml", kSmall);
  ASSERT_EQ(::chmod(path.c_str(), 0), 0);
  const NotRoot nobody;
  if (::access(path.c_str(), R_OK) == 0 && ::geteuid() == 0)
    GTEST_SKIP() << "runs as root and cannot drop that";
  expect_unreadable(path, ExitCode::no_permission, "Permission denied");
}

TEST(ConfigFile, EmptyIsBadData) {
  const TempDir dir;
  expect_unreadable(dir.write("a.yaml", ""), ExitCode::bad_data, "empty");
}

TEST(ConfigFile, TooLongIsBadData) {
  const TempDir dir;
  expect_unreadable(dir.write("a.yaml", std::string((1U << 20U) + 1, ' ')), ExitCode::bad_data,
                    "1 MiB");
  expect_unreadable("/dev/zero", ExitCode::bad_data, "1 MiB");
}

TEST(ConfigFile, BadContentIsBadData) {
  const TempDir dir;
  expect_unreadable(dir.write("a.yaml", replaced(kSmall, "1000", "x")), ExitCode::bad_data, "'x'");
}

}  // namespace
}  // namespace hapticd::config::test
