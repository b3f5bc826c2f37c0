#include "palpate/device/device.h"

#include "device/make.h"
#include "palpate/core/error.h"

namespace palpate::device {

void check_range(const char* key, double value, const Range& range) {
  if (!range.holds(value)) fail("device: {} = {} {}", key, value, range.demand());
}

void Device::open() {
  if (open_) return;
  do_open();
  open_ = true;
}

void Device::close() {
  if (!open_) return;
  open_ = false;
  do_close();
}

HandleSample Device::sample(double t) {
  open();
  last_ = do_sample(t);
  time_ = t;
  return last_;
}

void Device::feedback(double t, const Wrench& on_hand) {
  PALPATE_CHECK(open_, "a wrench for a device that is closed, at t = {}", t);
  do_feedback(t, on_hand);
}

}  // namespace palpate::device
