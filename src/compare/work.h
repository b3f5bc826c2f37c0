#pragma once
#include <atomic>

#include "palpate/compare/trajectory.h"

namespace palpate::compare {

/// Kinds of work that a process of its own does for a study.
enum class WorkKind { kReference, kPoint, kExchange, kMethods, kHaptic };

/// One piece of work as bytes.  The scene goes as its text, for the process knows nothing of the study: the
/// scene is made of its text alone, and its mesh files are found from the same folder.
/// @param limit_s  CPU seconds that the process will have, for its message
/// @param reference  reference for a point's error; null: no error is measured
std::string order_of(WorkKind kind, const scene::Description& description, double limit_s,
                     const Trajectory* reference);

/// A ProcessPool::Work: does what order_of() said.  @return what bytes_of() makes of a Run (of
/// kHaptic with wrenches alone), a PointRun, the exchange's points or the methods' points
std::string do_order(const std::string& order, const std::atomic<bool>& out_of_time);

}  // namespace palpate::compare
