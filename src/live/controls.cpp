#include "live/controls.h"

#include <chrono>
#include <utility>

namespace palpate::live {

Requests Controls::take() {
  const std::lock_guard lock(mutex_);
  leave_ = false;
  return std::exchange(pending_, {});
}

void Controls::wait(double seconds) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return pending_.any(); });
}

}  // namespace palpate::live
