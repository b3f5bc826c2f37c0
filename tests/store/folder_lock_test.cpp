// Only one process at a time may use a folder of results.
#include "store/folder_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <optional>

#include "palpate/core/error.h"
#include "store/sample_run.h"

using palpate::store::FolderLock;

namespace {

std::string refusal(const std::string& path) {
  try {
    const FolderLock mine(path);
  } catch (const palpate::Error& e) { return e.what(); }
  return "accepted";
}

/// Starts a process that holds the folder until it is killed.
pid_t holder_of(const std::string& path) {
  int ends[2];
  if (::pipe(ends) != 0) return -1;
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock mine(path);
    if (::write(ends[1], "x", 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char ready = 0;
  if (::read(ends[0], &ready, 1) != 1) return -1;
  ::close(ends[0]), ::close(ends[1]);
  return child;
}

TEST(FolderLock, IsMadeWithItsParentsAndFreeAgainAfterItsOwner) {
  const sample_run::Folder folder;
  const std::string path = folder / "a/b/c";
  { const FolderLock mine(path); }
  EXPECT_TRUE(std::filesystem::is_directory(path));
  EXPECT_TRUE(std::filesystem::is_empty(path)) << "no file is left";
  EXPECT_EQ(refusal(path), "accepted");
}

TEST(FolderLock, OfAnotherProcessIsRefusedWithItsNumber) {
  const sample_run::Folder folder;
  const std::string path = folder / "runs";
  const pid_t child = holder_of(path);
  ASSERT_GT(child, 0);
  const std::string message = refusal(path);
  EXPECT_TRUE(message.starts_with(path + ": process " + std::to_string(child) + " (")) << message;
  EXPECT_NE(message.find("store_test"), std::string::npos) << message;
  EXPECT_TRUE(
      message.ends_with("is writing into this folder; wait until it has ended, or choose another with "
                        "-o DIR"))
      << message;
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(refusal(path), "accepted") << "the lock of a killed process goes with it";
}

TEST(FolderLock, IsHeldOnceInAProcessToo) {
  const sample_run::Folder folder;
  std::optional<FolderLock> first(std::in_place, folder / "runs");
  EXPECT_NE(refusal(folder / "runs"), "accepted");
  FolderLock second = std::move(*first);
  first.reset();
  EXPECT_NE(refusal(folder / "runs"), "accepted") << "the lock has moved";
  second = FolderLock();
  EXPECT_EQ(refusal(folder / "runs"), "accepted");
}

TEST(FolderLock, AFileOfThatNameIsRefused) {
  const palpate::TemporaryFolder folder;
  const std::string path = folder.write("file", "mine").string();
  EXPECT_EQ(refusal(path),
            path + ": this output folder cannot be created (Not a directory); choose another with -o DIR");
}

}  // namespace
