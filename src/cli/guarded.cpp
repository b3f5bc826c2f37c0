#include "cli/guarded.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "cli/stop.h"
#include "cli/streams.h"
#include "core/memory.h"
#include "palpate/core/error.h"

namespace palpate::cli {
namespace {

int refuse(const std::string& why) {
  fmt::print(stderr, "palpate: error: {}\n", why);
  return kExitError;
}

int refuse_memory() {
  const AvailableMemory left = available_memory();
  return refuse(
      fmt::format("not enough memory: {} are available ({}); use a coarser mesh (element_size_m), fewer "
                  "tetrahedra or fewer recorded states",
                  memory_text(left.bytes), left.limited_by));
}

int run(const std::function<int()>& action, const char* input) {
  try {
    return action();
  } catch (const Error& e) { return refuse(e.what()); } catch (const std::bad_alloc&) {
    return refuse_memory();
  } catch (const std::length_error&) {  // a size beyond the address space
    return refuse_memory();
  } catch (const std::filesystem::filesystem_error& e) {
    return refuse(fmt::format("{}: {}", e.path1().string(), e.code().message()));
  } catch (const std::system_error& e) { return refuse(e.what()); } catch (const std::exception& e) {
    fmt::print(stderr,
               "palpate: internal error: {}\nThis is an error in palpate, not in your input: please report "
               "it with the {} and this message.\n",
               e.what(), input);
    return kExitInternalError;
  }
}

}  // namespace

int guarded(const std::function<int()>& action, const char* input) {
  const int status = run(action, input);
  if (const std::string why = output_failure(); !why.empty() && status == 0)
    return refuse(fmt::format("standard output is incomplete: {}; all other outputs are complete", why));
  return status;
}

}  // namespace palpate::cli
