#pragma once

namespace palpate::bench {

/// Most memory [bytes] that the process held since this was made, above what it held then; NaN where the
/// system does not tell.
class PeakMemory {
 public:
  PeakMemory();
  double bytes() const;

 private:
  double before_;
};

}  // namespace palpate::bench
