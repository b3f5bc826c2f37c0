// Available memory: the smaller of the kernel's figure and the control group's limit.
#include "core/memory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "palpate/core/error.h"
#include "temporary_folder.h"

using palpate::available_memory;

namespace {

namespace fs = std::filesystem;
constexpr double kMiB = 1024.0 * 1024.0;

class Machine {
 public:
  void file(const std::string& path, const std::string& text) const {
    fs::create_directories((folder_ / path).parent_path());
    folder_.write(path, text);
  }
  std::string root() const { return folder_.string(); }

 private:
  palpate::TemporaryFolder folder_;
};

TEST(Memory, OfAMachineWithoutLimits) {
  const Machine machine;
  EXPECT_TRUE(std::isinf(available_memory(machine.root()).bytes)) << "nothing to read";
  machine.file("proc/meminfo",
               "MemTotal: 4096000 kB\nMemFree: 1 kB\nMemAvailable:  204800 kB\nBuffers: 3 kB\n");
  machine.file("proc/self/cgroup", "0::/user/session\n");
  machine.file("sys/fs/cgroup/user/session/memory.max", "max\n");
  machine.file("sys/fs/cgroup/user/session/memory.current", "1000\n");
  const palpate::AvailableMemory got = available_memory(machine.root());
  EXPECT_EQ(got.bytes, 200.0 * kMiB);
  EXPECT_EQ(got.limited_by, "MemAvailable of /proc/meminfo");
}

TEST(Memory, OfAGroupWhoseParentIsLimited) {
  const Machine machine;
  machine.file("proc/meminfo", "MemAvailable: 2048000 kB\n");
  machine.file("proc/self/cgroup", "0::/user/session\n");
  machine.file("sys/fs/cgroup/user/session/memory.max", "max\n");
  machine.file("sys/fs/cgroup/user/session/memory.current", "1000\n");
  machine.file("sys/fs/cgroup/user/memory.max", "104857600\n");
  machine.file("sys/fs/cgroup/user/memory.current", "62914560\n");
  machine.file("sys/fs/cgroup/user/memory.stat", "anon 5\ninactive_file 20971520\n");
  const palpate::AvailableMemory got = available_memory(machine.root());
  EXPECT_EQ(got.bytes, 60.0 * kMiB) << "100 MiB, 60 of them taken, 20 of these of files";
  EXPECT_TRUE(got.limited_by.ends_with("sys/fs/cgroup/user")) << got.limited_by;
}

TEST(Memory, OfAGroupOfVersionOne) {
  const Machine machine;
  machine.file("proc/meminfo", "MemAvailable: 2048000 kB\n");
  machine.file("proc/self/cgroup", "9:name=systemd:/\n4:memory:/in/a/container\n0::/\n");
  machine.file("sys/fs/cgroup/memory/memory.limit_in_bytes", "52428800\n");
  machine.file("sys/fs/cgroup/memory/memory.usage_in_bytes", "41943040\n");
  EXPECT_EQ(available_memory(machine.root()).bytes, 10.0 * kMiB)
      << "its path is that of outside: the top counts";
  machine.file("sys/fs/cgroup/memory/memory.usage_in_bytes", "99999999\n");
  EXPECT_EQ(available_memory(machine.root()).bytes, 0.0);
}

TEST(Memory, WhatDoesNotFitIsRefusedWithBothFigures) {
  palpate::refuse_beyond_memory("a scene", 1000.0, "", "");
  try {
    palpate::refuse_beyond_memory("scene \"s\": 3 nodes", 3e18, "all for nothing",
                                  "a smaller one needs less");
    FAIL() << "3 EB are not there";
  } catch (const palpate::Error& e) {
    const std::string message = e.what();
    EXPECT_TRUE(
        message.starts_with("scene \"s\": 3 nodes need about 2793967723.8 GiB of memory (all for nothing), "
                            "but only "))
        << message;
    EXPECT_NE(message.find(" are available ("), std::string::npos) << message;
    EXPECT_NE(message.find("); a smaller one needs less, or continue anyway with --beyond-memory"),
              std::string::npos)
        << message;
  }
  ::setenv("PALPATE_BEYOND_MEMORY", "1", 1);
  EXPECT_NO_THROW(palpate::refuse_beyond_memory("a scene", 3e18, "", ""));
  ::unsetenv("PALPATE_BEYOND_MEMORY");
}

TEST(Memory, Words) {
  EXPECT_EQ(palpate::memory_text(340.4 * kMiB), "340 MiB");
  EXPECT_EQ(palpate::memory_text(1.26 * 1024.0 * kMiB), "1.3 GiB");
}

}  // namespace
