// A reader that dies does so in a child process: here by signals, by endless work and by excessive memory
// use.
#include "core/sandbox.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <new>

#include "palpate/core/error.h"
#include "temporary_folder.h"

using palpate::sandboxed_read;

namespace {

std::string refusal(const std::function<void()>& read, const std::string& path = "f.h5") {
  try {
    sandboxed_read(path, "HDF5", read);
  } catch (const palpate::Error& e) { return e.what(); }
  return "accepted";
}

TEST(Rehearsal, OfAGoodFileChangesNothingHere) {
  int calls = 0;
  EXPECT_EQ(refusal([&] { ++calls; }), "accepted");
  EXPECT_EQ(calls, 0) << "it was in the child";
  EXPECT_EQ(palpate::rehearsed("f.h5", "HDF5", [&] { return ++calls; }), 1) << "then here, once";
}

TEST(Rehearsal, ARefusalComesThroughInItsWords) {
  const std::string words = "f.h5:3: " + std::string(100000, 'x');
  EXPECT_EQ(refusal([&] { throw palpate::Error(words); }), words);
}

TEST(Rehearsal, TheChildsDeathIsARefusal) {
  EXPECT_EQ(
      refusal([] { std::raise(SIGKILL); }),
      "f.h5: is damaged: HDF5 fails while reading it (it does not terminate); copy it again, or recreate it");
  EXPECT_EQ(
      refusal([] {
        std::signal(SIGSEGV, SIG_DFL);
        std::raise(SIGSEGV);
      }),
      "f.h5: is damaged: HDF5 fails while reading it (Segmentation fault); copy it again, or recreate it");
  EXPECT_EQ(refusal([] { ::_exit(0); }),
            "f.h5: is damaged: HDF5 fails while reading it (status 0); copy it again, or recreate it");
  EXPECT_EQ(refusal([] { throw std::runtime_error("of the library"); }),
            "f.h5: is damaged: HDF5 fails while reading it (status 1); copy it again, or recreate it");
  EXPECT_EQ(refusal([] { throw std::bad_alloc(); }),
            "f.h5: reading it takes more memory than is available; it is damaged or too large");
  EXPECT_LE(::waitpid(-1, nullptr, WNOHANG), 0) << "an ended child was left";
}

#ifndef PALPATE_SANITIZED
TEST(Rehearsal, MemoryIsBounded) {
  const palpate::TemporaryFolder folder;
  const std::string path = folder.write("small.h5", "a few bytes").string();
  const auto take = [](std::size_t bytes) {
    return [bytes] {
      if (std::string(bytes, 'x').back() == 'y') ::_exit(3);
    };
  };
  EXPECT_EQ(refusal(take(std::size_t{8} << 30), path),
            path + ": reading it takes more memory than is available; it is damaged or too large");
  EXPECT_EQ(refusal(take(std::size_t{64} << 20), path), "accepted");
}
#endif

TEST(Rehearsal, IsNotRepeatedInsideItself) {
  EXPECT_EQ(refusal([] {
              const pid_t child = ::getpid();
              sandboxed_read("inner.h5", "HDF5", [] { ::_exit(7); });
              if (::getpid() != child) ::_exit(8);
            }),
            "accepted");
  const palpate::NoSandbox here;
  int calls = 0;
  EXPECT_EQ(palpate::rehearsed("f.h5", "HDF5", [&] { return ++calls; }), 1);
}

}  // namespace
