#pragma once
#include <atomic>

#include "palpate/compare/trajectory.h"

namespace palpate::compare {

/// Kinds of work that a separate process does for a study.
enum class WorkKind { kReference, kPoint, kExchange, kMethods, kHaptic };

/// Encodes one piece of work.  The scene is passed as text: the process has no access to the study, the scene
/// depends on its text only, and its mesh files are found relative to the same folder.
/// @param limit_s  CPU limit of the process [s], for its message
/// @param reference  reference for a point's error; null: no error is measured
std::string encode_job(WorkKind kind, const scene::Description& description, double limit_s,
                       const Trajectory* reference);

/// Does the work encoded by encode_job(); a ProcessPool::Work.  @return bytes_of() a Run (wrenches only for
/// kHaptic), a PointRun, the exchange study or the methods' points
std::string run_job(const std::string& order, const std::atomic<bool>& out_of_time);

}  // namespace palpate::compare
