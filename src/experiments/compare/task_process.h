#pragma once
#include <atomic>
#include <string>

#include "palpate/experiments/trajectory.h"

namespace palpate::compare {

/// Kinds of work that a separate process does for a comparison.
enum class WorkKind { kReference, kPoint, kExchange, kMethods, kHaptic, kMesh };

/// Encodes one piece of work.  The scene is passed as text: the process has no access to the comparison, the
/// scene depends on its text only, and its mesh files are found relative to the same folder.
/// @param limit_s  CPU limit of the process [s], for its message
/// @param reference  reference for a point's error; null: no error is measured
std::string encode_job(WorkKind kind, const scene::Description& description, double limit_s,
                       const Trajectory* reference);

/// Does the work encoded by encode_job(); a ProcessPool::Work.  @return an experiments::Result, whose bytes
/// are a Run (kReference; kHaptic: wrenches only), a PointRun, an ExchangeStudy, Methods, or a MeshRun
std::string run_job(const std::string& input, const std::atomic<bool>& out_of_time);

}  // namespace palpate::compare
