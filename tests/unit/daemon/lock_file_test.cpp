#include "daemon/lock_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "tests/unit/daemon/temp_dir.h"

namespace hapticd::daemon {
namespace {

using testing::HasSubstr;

TEST(LockFile, ASecondHolderIsToldWhoTheFirstIs) {
  const test::TempDir dir;
  const auto first = LockFile::acquire(dir.file("a.lock"), "the thing");
  ASSERT_TRUE(first) << first.error().text;
  const auto second = LockFile::acquire(dir.file("a.lock"), "the thing");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ExitCode::try_again);
  EXPECT_THAT(second.error().text,
              HasSubstr("pid " + std::to_string(::getpid()) + ") holds the thing"));
}

TEST(LockFile, IsFreeAgainOnceLetGo) {
  const test::TempDir dir;
  { const auto first = LockFile::acquire(dir.file("a.lock"), "it"); }
  EXPECT_TRUE(LockFile::acquire(dir.file("a.lock"), "it"));
}

TEST(LockFile, MovingKeepsTheLock) {
  const test::TempDir dir;
  auto first = LockFile::acquire(dir.file("a.lock"), "it");
  std::optional<LockFile> kept(std::move(*first));
  EXPECT_FALSE(LockFile::acquire(dir.file("a.lock"), "it"));
  kept.reset();
  EXPECT_TRUE(LockFile::acquire(dir.file("a.lock"), "it"));
}

TEST(LockFile, TheLockOfADeadProcessIsNoLock) {
  const test::TempDir dir;
  const pid_t child = ::fork();
  if (child == 0) {
    const auto lock = LockFile::acquire(dir.file("a.lock"), "it");
    ::_exit(lock ? 0 : 1);  // no destructor runs, as after SIGKILL
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(LockFile::acquire(dir.file("a.lock"), "it"));
}

TEST(LockFile, AnUnreadableHolderIsSaidToBeUnknown) {
  const test::TempDir dir;
  const auto first = LockFile::acquire(dir.file("a.lock"), "it");
  std::ofstream(dir.file("a.lock")) << "rubbish\n";
  const auto second = LockFile::acquire(dir.file("a.lock"), "it");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().text, HasSubstr("pid not known"));
}

TEST(LockFile, DoesNotFollowALink) {
  const test::TempDir dir;
  std::filesystem::create_symlink(dir.file("elsewhere"), dir.file("a.lock"));
  const auto lock = LockFile::acquire(dir.file("a.lock"), "it");
  ASSERT_FALSE(lock);
  EXPECT_FALSE(std::filesystem::exists(dir.file("elsewhere")));
}

TEST(LockFile, AMissingDirectoryIsAnErrorThatNamesIt) {
  const test::TempDir dir;
  const auto lock = LockFile::acquire(dir.file("none/a.lock"), "it");
  ASSERT_FALSE(lock);
  EXPECT_EQ(lock.error().code, ExitCode::cannot_create);
  EXPECT_THAT(lock.error().text, HasSubstr("none/a.lock"));
}

TEST(DeviceLock, HoldsInEveryDirectoryThatItCan) {
  const test::TempDir one, two;
  const auto locks = lock_device("usb:1-2/3", {one.path(), one.file("none"), two.path()});
  ASSERT_TRUE(locks) << locks.error().text;
  EXPECT_EQ(locks->size(), 2u);
  // Another program that sees only one of the directories is kept out all the same.
  EXPECT_FALSE(lock_device("usb:1-2/3", {two.path()}));
  EXPECT_TRUE(lock_device("usb:1-2/4", {two.path()}));
}

TEST(DeviceLock, FailsWhereNoDirectoryCanHoldIt) {
  const test::TempDir dir;
  const auto locks = lock_device("can0/1", {dir.file("none")});
  ASSERT_FALSE(locks);
  EXPECT_EQ(locks.error().code, ExitCode::cannot_create);
}

}  // namespace
}  // namespace hapticd::daemon
