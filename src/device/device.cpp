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

void Device::archive(Archive& a) {
  PALPATE_CHECK(can_be_archived(), "a device that cannot be archived");
  bool was_open = open_;
  a("open", was_open);
  if (was_open) open();
  a("last", last_);
  a("time", time_);
  do_archive(a);
}

void Device::feedback(double t, const Wrench& on_hand) {
  PALPATE_CHECK(open_, "a wrench for a device that is closed, at t = {}", t);
  do_feedback(t, on_hand);
}

}  // namespace palpate::device
