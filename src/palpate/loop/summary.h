#pragma once
#include "palpate/loop/run.h"
#include "palpate/scene/needs.h"
#include "palpate/store/summary.h"

namespace palpate::loop {

/// scene::needs() with the linear solver that the scene's integrator will use.
std::vector<scene::Need> needs(const scene::Description& description);

/// What the device of a hand has counted (device::Device::tallies).
std::vector<std::pair<std::string, long long>> tallies_of(const World& world, std::size_t hand);

/// Summary of a run and its cost: options, sizes, counts, timings, constructions.  The caller adds the
/// command line and writes it.
store::Summary summarise(const World& world, const RunResult& result, double assemble_s);

}  // namespace palpate::loop
