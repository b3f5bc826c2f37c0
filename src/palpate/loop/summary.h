#pragma once
#include "palpate/loop/run.h"
#include "palpate/scene/needs.h"
#include "palpate/store/summary.h"

namespace palpate::loop {

/// scene::needs() with the linear solver that the scene's integrator will use.
std::vector<scene::Need> needs(const scene::Description& description);

/// Summary of a run and its cost: options, sizes, counts, timings, constructions.  The caller adds the
/// command line and writes it.
store::Summary summarise(const World& world, const RunResult& result, double assemble_s);

}  // namespace palpate::loop
