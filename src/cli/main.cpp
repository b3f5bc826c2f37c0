#include "commands.h"
#include "guarded.h"
#include "palpate/core/log.h"
#include "palpate/core/process_pool.h"
#include "stop.h"
#include "streams.h"
#include "tune.h"

namespace palpate::cli {
namespace {

int run_guarded(const std::function<int()>& action) { return guarded(action, "scene"); }

int run_action(const Invocation& invocation) {
  const int status = invocation.action();
  return stop_flag() && status == 0 ? kExitStopped : status;
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  using namespace palpate::cli;
  end_where_loading_is_tried();
  palpate::log::configure(false, false);  // takes standard error as it is, for its colours
  guard_streams();
  Invocation invocation;
  const int parsed = run_guarded([&] {
    invocation = parse(argc, argv);
    return 0;
  });
  if (!invocation.action) return parsed;
  if (invocation.factorises) restart_tuned(argv);
  if (invocation.starts_processes) {
    const int prepared = run_guarded([] {
      palpate::ProcessPool::prepare();
      return 0;
    });
    if (prepared != 0) return prepared;
  }
  palpate::log::configure(invocation.quiet, invocation.verbose);
  catch_stop_signals();
  return run_guarded([&] { return run_action(invocation); });
}
