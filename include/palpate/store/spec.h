#pragma once

namespace palpate {

/// Settings of a scene's `[record]` table.  A file with nothing to record is not created.
struct RecordSpec {
  bool states = true;  ///< Whether to write the VTKHDF time series.
  /// Period of recorded states [s], rounded to a multiple of the exchange period.
  double state_period_s = 0.02;
  bool forces = true;   ///< Whether to write force.csv, one line per tick; requires a [tool].
  bool energy = false;  ///< Whether to write energy.csv, one line per period of the loop, and the balance.
};

}  // namespace palpate
