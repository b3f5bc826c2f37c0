#include "linear/mixed_precision/solve_state.h"

#include <algorithm>

namespace palpate::linear {

namespace {
/// Solutions kept for the initial guess: many for tight tolerances, few for others, where one more saves
/// fewer iterations than it costs.
constexpr double kManyStarts = 1e-4;
constexpr int kFewColumns = 3;
}  // namespace

SolveState::SolveState(const NodeKernels& kernel_set, ClusterTeam& threads, SingleMatrix& matrix,
                       const RigidModeCoarseSpace& coarse_space, double tolerance,
                       dynamics::SolverCounters& counts)
    : kernels(kernel_set),
      team(threads),
      copy(matrix),
      rtol(tolerance),
      counters(counts),
      guess(kernel_set, tolerance < kManyStarts ? kMostColumns : kFewColumns),
      iteration(kernel_set, threads, matrix, coarse_space) {}

void SolveState::prepare() {
  iteration.prepare();
  guess.prepare(copy.order());
  largest.assign(static_cast<std::size_t>(copy.order().parts()), 0.0);
  for (Doubles* v : {&b, &x}) v->assign(4 * static_cast<std::size_t>(nodes()) + kVectorTail, 0.0);
}

void SolveState::begin(bool warm) {
  accumulated = false;
  iteration.restart();
  guess.begin(warm, copy.scale());
}

ProjectedGuess::Start SolveState::choose() {
  const ProjectedGuess::Start start = guess.choose();
  size = start.size;
  return start;
}

const double* SolveState::solution(int first, int last, Block& block) const {
  if (accumulated && !iteration.moved()) return x.data() + 4 * static_cast<std::ptrdiff_t>(first);
  if (accumulated)
    std::copy_n(x.data() + 4 * static_cast<std::ptrdiff_t>(first), 4 * (last - first), block.data());
  else
    guess.solution(block.data(), first, last);
  if (iteration.moved()) iteration.correct(copy.scale() * size, block.data(), first, last);
  return block.data();
}

void SolveState::add_correction() {
  team.for_each([&](std::size_t, int first, int last) {
    double* here = x.data() + 4 * static_cast<std::ptrdiff_t>(first);
    if (!accumulated) guess.solution(here, first, last);
    if (iteration.moved()) iteration.correct(copy.scale() * size, here, first, last);
  });
  accumulated = true;
  iteration.clear_correction();
}

double SolveState::put_solution(double* out, bool keep, bool follow) {
  const int* node = copy.order().node.data();
  if (keep) guess.begin_to_keep(copy.scale(), follow);
  team.for_each([&](std::size_t part, int begin, int end) {
    double most = 0.0;
    for (int first = begin; first < end; first += kNodesOfBlock) {
      const int last = std::min(end, first + kNodesOfBlock);
      Block value, image;
      const double* from = solution(first, last, value);
      most = std::max(most, kernels.scatter_nodes(node, from, out, first, last));
      if (!keep) continue;
      if (follow) kernels.image(size, b.data(), iteration.residual().data(), image.data(), first, last);
      guess.keep(from, image.data(), first, last);
    }
    largest[part] = most;
  });
  const double most = *std::max_element(largest.begin(), largest.end());
  if (keep) guess.end_to_keep(most);
  return most;
}

}  // namespace palpate::linear
