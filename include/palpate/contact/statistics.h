#pragma once
#include <cmath>
#include <string>

#include "palpate/contact/sample_source.h"

namespace palpate::contact {

/// Magnitude of the resultant of a contact pair on one of its bodies, or of a change of it.
struct ResultantSize {
  double force = 0.0;   ///< Magnitude of the force [N].
  double moment = 0.0;  ///< Magnitude of the moment about the body's mean node or the frame's origin [N m].
};

/// Statistics of the grasps of all frames.
struct GraspCounts {
  long closed = 0;            ///< Number of grasps that began to hold something.
  long empty = 0;             ///< Number of grasp commands for which no sample was under pressure.
  int points = 0;             ///< Points held at present.
  double area = 0.0;          ///< Area held at present [m^2].
  double largest_area = 0.0;  ///< Largest area held at any time so far [m^2].
};

/// Statistics of all contacts of a scene since the start; each value is the largest of all pairs.
struct ContactStatistics {
  long queries = 0;             ///< Number of refreshes, the first included.
  double query_seconds = 0.0;   ///< Wall time spent in refreshes [s].
  double safe_time = HUGE_VAL;  ///< Smallest safe time of the pairs (SourceReport::safe_time) [s].
  /// Change of a pair's resultant on its bodies caused by the last refresh, at the state of that refresh. It
  /// measures the error due to infrequent queries. The same resultant distributed to other nodes is no
  /// change.
  ResultantSize refresh_jump;
  ResultantSize largest_jump;  ///< Largest refresh_jump of all refreshes.
  /// Largest resultant of one pair on one body after a refresh, as a reference for `largest_jump`.
  ResultantSize largest_resultant;
  /// Largest friction force that a step neglected because the pressure changed and the friction did not, as
  /// the norm of a pair's sum [N]. Concerns the pairs with a symmetric tangent ("friction_tangent" symmetric
  /// or secant).
  double largest_friction_lag = 0.0;
  /// Largest friction force of these pairs, as the norm of a pair's sum [N].
  double largest_lagged_friction = 0.0;
  GraspCounts grasps;  ///< Grasps of all frames.
};

/// Report of one contact pair.
struct PairReport : SourceReport {
  std::string method;    ///< Name of its source ("distance", "plane").
  double deepest = 0.0;  ///< Largest overlap along its normal that a query found [m]; 0: never touched.
};

}  // namespace palpate::contact
