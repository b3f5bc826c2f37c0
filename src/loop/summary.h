#pragma once
#include "checkpoints.h"
#include "palpate/loop/run.h"
#include "run_figures.h"
#include "scene/needs.h"
#include "store/summary.h"

namespace palpate::loop {

/// Returns scene::needs() with the linear solver that the scene's integrator will use.
std::vector<scene::Need> needs(const scene::Description& description);

/// Returns the counters of a hand's device (device::Device::counters).
std::vector<std::pair<std::string, long long>> tallies_of(const World& world, std::size_t hand);

/// Error of the reduced response of the bodies to a tool (ReductionError), for "points": relative upper
/// bounds over the exchanges.
struct AnswerError {
  std::string tool;                  ///< Name in [[contact]].
  double requested = 0.0;            ///< exchange.linearisation_error
  double largest = 0.0, mean = 0.0;  ///< Largest and mean bound over the exchanges.
  long exchanges = 0;                ///< Exchanges with contact.
  long beyond = 0;                   ///< Exchanges whose iteration ended above the requested error.
  long factored = 0;                 ///< Exchanges with a factored step matrix, which are exact.
};
/// Returns one entry per tool that was in contact with a body in this way.
std::vector<AnswerError> answer_errors_of(const World& world);

/// Returns the summary of a run and its cost, by the keys of docs/files.md: options, sizes, counts, timings,
/// hands, contacts, parts, constructions. The caller adds the command line and writes it.
/// @param figures  observer of the run; without its peaks the hands have none in the summary
store::Summary summarise(const World& world, const RunResult& result, double assemble_s,
                         const RunFigures& figures = {});

/// Adds the cost of checkpoints.  @param every_s  simulated time between two of them [s]
void add_checkpoints(store::Summary& summary, const CheckpointCost& cost, double every_s);

}  // namespace palpate::loop
