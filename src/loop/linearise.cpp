#include "linearise.h"

#include "core/counters.h"
#include "coupling/condensation.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

CoupledTool coupled_tool(World& world, const ToolInstance& tool, const contact::TrajectoryFrame::Knot& now) {
  CoupledTool out{world.system, world.state, *world.contact, tool.frame, {now.pose, now.twist}};
  for (const ToolInstance& other : world.tools)
    if (&other != &tool && other.frame >= 0)
      out.others.push_back({other.frame, other.partitioned()->path->last().twist});
  return out;
}

}  // namespace

ContactRecord linearise_contact(World& world, std::uint64_t version, double period_s, long& frozen_fallbacks,
                                std::size_t hand) {
  using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  using Source = dynamics::LinearisedContact::Source;
  counters::count("loop.exchange_record");
  ToolInstance& tool = world.tools.at(hand);
  PartitionedTool& partitioned = *tool.partitioned();
  ContactRecord out;
  dynamics::LinearisedContact& record = out.linear;
  record.version = version;
  record.time = world.state.time();
  if (tool.frame < 0) return out;
  const contact::TrajectoryFrame::Knot& now = partitioned.path->last();
  set_reference(record, record.time, now.pose, now.twist);
  const CoupledTool coupled = coupled_tool(world, tool, now);
  if (partitioned.reduction) {
    frozen_fallbacks += !partitioned.reduction->reduce(coupled, period_s, out.touch);
    record.source = Source::kPoints;
    record.samples = out.touch.samples;
    return out;
  }
  contact::FrameLinearisation c;
  world.contact->linearise(world.state.view(), tool.frame, c, contact::Partners::kNodes);
  record.samples = c.active;
  Eigen::Map<Vec6>(record.F0.data()) << c.wrench.moment, c.wrench.force;
  Eigen::Map<RowMajor6>(record.J.data()) = -c.K;
  Eigen::Map<RowMajor6>(record.B.data()) = -c.B;
  record.source = Source::kFrozen;
  const bool condensed = world.description.exchange.linearisation == "condensed";
  if (condensed && c.active > 0 &&
      !condense(coupled, partitioned.step_factor, period_s, tool.spec.tick_s, c, record))
    ++frozen_fallbacks;
  return out;
}

}  // namespace palpate::loop
