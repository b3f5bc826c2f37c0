#pragma once
#include <atomic>
#include <string>
#include <vector>

#include "palpate/experiments/comparison.h"

namespace palpate::compare {

/// Runs every refinement sequence of every scene at the scene's fixed exchange period, and compares it with
/// the scene's tight reference (methods of the reference's family are compared with its check).  Each run has
/// a separate process; repeats are interleaved over all points, so that disturbances of the machine affect
/// all alike.  The processes come from core's ProcessPool: a program that has started threads or drawn a
/// picture must have called ProcessPool::prepare() before.
/// @param options  selection, repeats and limits
/// @param scenes  from loop::load or loop::parse: results are stored under a hash of their text
/// @throws Error for invalid refinement sequences
Comparison run(const std::vector<scene::Description>& scenes, const CompareOptions& options);

/// Runs the scene with each contact method of `compare.contact_methods` for the tool, at the scene's
/// integrator settings.  A method that is not available, or whose run fails, is reported in
/// `trouble` of its point.
std::vector<MethodPoint> compare_contact_methods(const scene::Description& description,
                                                 const std::atomic<bool>* stop = nullptr);

/// Writes compare.csv, trials.csv, restarts.csv, exchange.csv, methods.csv and reference.json into `folder`:
/// report takes its tables, fitted orders and plots from them.
void write(const Comparison& comparison, const std::string& folder);

}  // namespace palpate::compare
