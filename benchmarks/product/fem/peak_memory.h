#pragma once

namespace palpate::bench {

/// Peak memory [bytes] of the process since this object was made, above its memory at that time; NaN if the
/// system does not report it.
class PeakMemory {
 public:
  PeakMemory();
  double bytes() const;

 private:
  double before_;
};

}  // namespace palpate::bench
