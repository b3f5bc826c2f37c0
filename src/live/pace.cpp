#include "live/pace.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/clock.h"

namespace palpate::live {
namespace {

constexpr double kNap = 0.01;      ///< Longest sleep between two looks at the controls [s].
constexpr double kForgiven = 0.1;  ///< Delay that is not made up for [s].

void sleep_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

}  // namespace

void Pace::period(loop::World& /*world*/, double t) {
  if (t == 0.0) start_s_ = woke_s_ = wall_seconds();
  const double before = wall_seconds();
  while (controls_.pause() && !controls_.leave()) sleep_for(kNap);
  start_s_ += wall_seconds() - before;
  const double due_s = start_s_ + t, arrived_s = before;
  const double late_s = std::max(0.0, arrived_s - due_s);
  if (late_s > kForgiven) start_s_ += late_s;
  if (t > 0.0)
    then_.timed({static_cast<float>(late_s), static_cast<float>(std::max(0.0, arrived_s - woke_s_)), 0, 0});
  wait_until(due_s);
  woke_s_ = wall_seconds();
}

void Pace::wait_until(double due_s) {
  for (double left = due_s - wall_seconds(); left > 0.0 && !controls_.leave(); left = due_s - wall_seconds())
    sleep_for(std::min(left, kNap));
}

}  // namespace palpate::live
