#include "palpate/core/team.h"

#include "core/active_group.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

void pause_briefly() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

struct Team::Group : ActiveGroup {};

Team::Team(int size) : size_(size), group_(std::make_unique<Group>()) {
  PALPATE_CHECK(size >= 1, "a team of {}", size);
  for (int k = 1; k < size; ++k) workers_.emplace_back([this, k] { live(k); });
}

Team::~Team() {
  if (workers_.empty()) return;
  ended_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void Team::wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t old) const {
  for (int i = 0; i < ActiveGroup::kSpins && group_->is_active(); ++i) {
    if (value.load(std::memory_order_acquire) != old) return;
    pause_briefly();
  }
  while (value.load(std::memory_order_acquire) == old) value.wait(old, std::memory_order_acquire);
}

void Team::live(int k) {
  for (std::uint32_t seen = 0;; ++seen) {
    wait_while(round_, seen);
    if (ended_) return;
    call_(work_, k);
    barrier();
  }
}

void Team::run_any(void (*call)(void*, int), void* work) {
  if (size_ == 1) return call(work, 0);
  group_->activate();
  call_ = call;
  work_ = work;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  call(work, 0);
  barrier();
}

void Team::barrier() {
  if (size_ == 1) return;
  const std::uint32_t phase = phase_.load(std::memory_order_acquire);
  if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == static_cast<std::uint32_t>(size_)) {
    arrived_.store(0, std::memory_order_relaxed);
    phase_.fetch_add(1, std::memory_order_release);
    phase_.notify_all();
  } else {
    wait_while(phase_, phase);
  }
}

}  // namespace palpate
