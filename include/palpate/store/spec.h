#pragma once

namespace palpate {

/// The `[record]` table of a scene.  Nothing recorded: no file.
struct RecordSpec {
  bool states = true;            ///< the VTKHDF time series
  double state_period_s = 0.02;  ///< rounded to a whole number of exchange periods
  bool forces = true;            ///< force.csv, one line a tick, where there is a tool
  bool energy = false;           ///< energy.csv, one line a period of the loop, and the summary's balance
};

}  // namespace palpate
