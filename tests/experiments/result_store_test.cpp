#include "experiments/result_store.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "experiments/unfinished_tasks.h"
#include "messages.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "temporary_folder.h"

using namespace palpate;
using experiments::Result;
using experiments::ResultStore;
using experiments::Status;
namespace fs = std::filesystem;

namespace {

experiments::Task task_of(const std::string& key) { return {"test", key, "the task " + key, nullptr, 1.0}; }

Result result_of(const std::string& bytes) {
  Result out;
  out.status = Status::kFailed;
  out.reason = "why";
  out.cpu_s = 0.25;
  out.limit_s = 3.0;
  out.bytes = bytes;
  return out;
}

std::string bytes_in(const ResultStore& store, const std::string& key) {
  const auto kept = store.find(key);
  return kept ? kept->bytes : "none";
}

}  // namespace

TEST(ResultStore, KeepsResultsInTheFolder) {
  const TemporaryFolder folder;
  {
    ResultStore store = ResultStore::here(folder.string(), false);
    EXPECT_FALSE(store.find("a"));
    store.put(task_of("a"), result_of("content"));
  }
  EXPECT_FALSE(fs::exists(folder / "tasks")) << "only elements of an array job need it";
  ResultStore store = ResultStore::here(folder.string(), false);
  const auto kept = store.find("a");
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->status, Status::kFailed);
  EXPECT_EQ(kept->reason, "why");
  EXPECT_EQ(kept->cpu_s, 0.25);
  EXPECT_EQ(kept->limit_s, 3.0);
  EXPECT_EQ(kept->bytes, "content");
  store = ResultStore();
  EXPECT_EQ(bytes_in(ResultStore::here(folder.string(), true), "a"), "none") << "fresh";
}

TEST(ResultStore, ResultsOfElementsAreCopiedAndTheirFilesRemoved) {
  const TemporaryFolder folder;
  for (const char* list : {"0-3", "7"}) {
    ResultStore element = ResultStore::element(folder.string(), list);
    element.put(task_of(list), result_of(list));
    EXPECT_FALSE(fs::exists(folder / "tasks" / (std::string(list) + ".db"))) << "not complete";
    element.close();
    EXPECT_TRUE(fs::exists(folder / "tasks" / (std::string(list) + ".db")));
  }
  const ResultStore store = ResultStore::read(folder.string());
  EXPECT_EQ(bytes_in(store, "0-3"), "0-3");
  EXPECT_EQ(bytes_in(store, "7"), "7");
  EXPECT_TRUE(fs::exists(folder / "results.db"));
  EXPECT_FALSE(fs::exists(folder / "tasks" / "7.db"));
}

TEST(ResultStore, WhatIsBeingWrittenIsNotRead) {
  const TemporaryFolder folder;
  ResultStore done = ResultStore::element(folder.string(), "1");
  done.put(task_of("a"), result_of("done"));
  done.close();
  ResultStore writing = ResultStore::element(folder.string(), "2");
  writing.put(task_of("b"), result_of("not yet"));

  const ResultStore read = ResultStore::read(folder.string());
  EXPECT_EQ(bytes_in(read, "a"), "done");
  EXPECT_EQ(bytes_in(read, "b"), "none");
  EXPECT_TRUE(fs::exists(folder / "tasks" / "1.db")) << "an element may read the folder";
  EXPECT_THROW(ResultStore::here(folder.string(), false), Error) << "the element would lose its file";
  writing = ResultStore();  // killed: its file stays as it is

  EXPECT_EQ(bytes_in(ResultStore::read(folder.string()), "b"), "not yet") << "no element runs";
  EXPECT_TRUE(ResultStore::read(folder.string(), true).find("b"));
  EXPECT_FALSE(fs::exists(folder / "tasks"));
}

TEST(ResultStore, AnElementGoesOnAfterARequeue) {
  const TemporaryFolder folder;
  {
    ResultStore main = ResultStore::here(folder.string(), false);
    main.put(task_of("m"), result_of("main"));
  }
  ResultStore killed = ResultStore::element(folder.string(), "2-3");
  killed.put(task_of("a"), result_of("kept"));
  killed = ResultStore();
  ResultStore again = ResultStore::element(folder.string(), "2-3");
  EXPECT_EQ(bytes_in(again, "a"), "kept");
  EXPECT_EQ(bytes_in(again, "m"), "main");
  again.close();
  EXPECT_EQ(bytes_in(ResultStore::element(folder.string(), "2-3"), "a"), "kept");
}

TEST(ResultStore, TheSameTasksDoNotRunTwiceAtATime) {
  const TemporaryFolder folder;
  ResultStore first = ResultStore::element(folder.string(), "2-3");
  first.put(task_of("a"), result_of("kept"));
  const std::string message = expectations::message_of([&] { ResultStore::element(folder.string(), "2-3"); });
  expectations::expect_contains(message, "these tasks already run, --task 2-3: ");
  ResultStore other = ResultStore::element(folder.string(), "4");
  other.close();
  first.close();
  { ResultStore again = ResultStore::element(folder.string(), "2-3"); }
  EXPECT_EQ(bytes_in(ResultStore::here(folder.string(), false), "a"), "kept");
  EXPECT_FALSE(fs::exists(folder / "tasks")) << "locks are removed with the files";
}

TEST(ResultStore, AnElementWaitsForACommandThatCopies) {
  const TemporaryFolder folder;
  store::FolderLock lock((folder / "tasks").string());
  std::thread copies([&] {
    usleep(300000);
    fs::remove(folder / "tasks");
    lock = {};
  });
  ResultStore element = ResultStore::element(folder.string(), "1");
  copies.join();
  element.put(task_of("a"), result_of("content"));
  element.close();
  EXPECT_EQ(bytes_in(ResultStore::read(folder.string()), "a"), "content");
}

TEST(ResultStore, ADamagedFileLosesItsTasksOnly) {
  const TemporaryFolder folder;
  for (const char* list : {"1", "2"}) {
    ResultStore element = ResultStore::element(folder.string(), list);
    element.put(task_of(list), result_of(std::string(100000, 'x')));
    element.close();
  }
  const std::string path = (folder / "tasks" / "1.db").string();
  store::write_atomically(path, store::read_file(path).substr(0, 100));
  const ResultStore store = ResultStore::here(folder.string(), false);
  EXPECT_FALSE(store.find("1"));
  EXPECT_TRUE(store.find("2"));
  EXPECT_TRUE(fs::exists(path + ".damaged")) << "somebody may repair it";
  EXPECT_FALSE(fs::exists(folder / "tasks" / "2.db"));
}

TEST(ResultStore, WhatCannotBeCopiedIsNotRemoved) {
  const TemporaryFolder folder;
  ResultStore element = ResultStore::element(folder.string(), "1");
  element.put(task_of("a"), result_of(std::string(1000000, 'x')));
  element.close();
  store::write_atomically((folder / "results.db").string(), "no database" + std::string(5000, 'x'));
  EXPECT_THROW(ResultStore::here(folder.string(), false), Error);
  EXPECT_THROW(ResultStore::read(folder.string()), Error);
  EXPECT_TRUE(fs::exists(folder / "tasks" / "1.db"));

  fs::remove(folder / "results.db");
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);  // Writes fail, as on a full disk.
  EXPECT_THROW(ResultStore::here(folder.string(), false), Error);
  EXPECT_THROW(ResultStore::read(folder.string(), true), Error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  signal(SIGXFSZ, SIG_DFL);
  EXPECT_TRUE(fs::exists(folder / "tasks" / "1.db"));
  EXPECT_TRUE(ResultStore::read(folder.string()).find("a"));
}

TEST(UnfinishedTasks, CountsWhatCompleteFilesDoNotHave) {
  const TemporaryFolder folder;
  experiments::UnfinishedTasks unfinished(folder.string(), {task_of("a"), task_of("b"), task_of("c")},
                                          {"0-1", "2"});
  EXPECT_EQ(unfinished.count(), 3u);
  ResultStore element = ResultStore::element(folder.string(), "0-1");
  element.put(task_of("a"), result_of("a"));
  Result early = result_of("b");
  early.status = Status::kOutOfTime;
  early.limit_s = 0.5;
  element.put(task_of("b"), early);
  EXPECT_EQ(unfinished.count(), 3u) << "not complete";
  element.close();
  EXPECT_EQ(unfinished.count(), 2u) << "the limit of b is 1 s";
  EXPECT_EQ(unfinished.count(), 2u);
  EXPECT_FALSE(unfinished.all_ended());
  element = ResultStore::element(folder.string(), "2");
  element.put(task_of("c"), result_of("c"));
  element.close();
  EXPECT_EQ(unfinished.count(), 1u);
  EXPECT_TRUE(unfinished.all_ended()) << "both elements have ended";
}

TEST(Status, HasOneNamePerValue) {
  for (int i = 0; i < experiments::kStatuses; ++i) {
    const auto status = static_cast<Status>(i);
    EXPECT_EQ(experiments::status_of(to_string(status)), status);
  }
  EXPECT_EQ(experiments::status_of("no such status"), Status::kMissing);
}
