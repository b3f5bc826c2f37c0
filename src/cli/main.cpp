#include <cstdio>
#include <exception>
#include <new>

#include "commands.h"
#include "palpate/core/error.h"
#include "palpate/core/log.h"
#include "palpate/core/memory.h"
#include "palpate/core/process_pool.h"
#include "stop.h"
#include "tune.h"

namespace palpate::cli {
namespace {

/// Every way out has one sentence and one exit status.
int guarded(const std::function<int()>& action) {
  try {
    const int status = action();
    return stop_flag() && status == 0 ? kExitStopped : status;
  } catch (const Error& e) {
    fmt::print(stderr, "palpate: error: {}\n", e.what());
    return kExitError;
  } catch (const std::bad_alloc&) {
    const palpate::AvailableMemory left = palpate::available_memory();
    fmt::print(
        stderr,
        "palpate: error: not enough memory: {} are left ({}); a coarser mesh (element_size_m) or fewer "
        "recorded states need less\n",
        palpate::memory_text(left.bytes), left.limited_by);
    return kExitError;
  } catch (const std::exception& e) {
    fmt::print(stderr,
               "palpate: internal error: {}\nThis is a mistake in palpate, not in your input: please report "
               "it with the scene and this message.\n",
               e.what());
    return kExitInternalError;
  }
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  using namespace palpate::cli;
  Invocation invocation;
  const int parsed = guarded([&] {
    invocation = parse(argc, argv);
    return 0;
  });
  if (!invocation.action) return parsed;
  if (invocation.factorises) restart_tuned(argv);
  if (invocation.starts_processes) {
    const int prepared = guarded([] {
      palpate::ProcessPool::prepare();
      return 0;
    });
    if (prepared != 0) return prepared;
  }
  palpate::log::configure(invocation.quiet, invocation.verbose);
  catch_stop_signals();
  return guarded(invocation.action);
}
