// State of contact in a checkpoint.
#include <algorithm>

#include "contact/contact_force_impl.h"

namespace palpate::contact {
namespace {

void archive(Archive& a, SurfacePoint& point) {
  a("frame", point.frame);
  a("count", point.count);
  a.each("node", point.node, [&](int& node) { a("n", node); });
  a.numbers("weight", point.weight);
  a("offset", point.offset);
  a("slide", point.slide);
}

void archive(Archive& a, std::string_view name, ResultantSize& size) {
  const Archive::Group group(a, name);
  a("force", size.force);
  a("moment", size.moment);
}

}  // namespace

/// Saves or restores the held points. Ties come from the scene: they precede held points in the list and are
/// kept.
void Bonds::archive(Archive& a) {
  const auto first =
      std::find_if(bonds_.begin(), bonds_.end(), [](const Bond& bond) { return bond.pair != Bond::kTied; });
  std::vector<Bond> grasped(first, bonds_.end());
  a.list("bond", grasped, [&](Bond& bond) {
    {
      const Archive::Group group(a, "held");
      contact::archive(a, bond.held);
    }
    a("frame", bond.frame);
    a("anchor", bond.anchor);
    a("normal", bond.normal);
    a("stiffness", bond.stiffness);
    a("damping", bond.damping);
    a("area", bond.area);
    a("pair", bond.pair);
    a("frame_is_a", bond.frame_is_a);
  });
  bonds_.erase(first, bonds_.end());
  bonds_.insert(bonds_.end(), grasped.begin(), grasped.end());
}

// The query comes last, because it uses the restored state of earlier queries.
void ContactForce::archive(Archive& a, const dynamics::StateView& state) {
  Impl& m = *impl_;
  a.each("pair", m.pairs, [&](Impl::Pair& pair) {
    pair.source->archive(a);
    a("deepest", pair.deepest);
    if (pair.anchors.on()) pair.anchors.archive(a);
  });
  a("bonds", m.bonds);
  a.list("grasp", m.grasps, [&](Impl::Grasp& grasp) {
    a("frame", grasp.frame);
    a("wanted", grasp.requested);
    a("closed", grasp.closed);
  });
  GraspCounts& grasped = m.grasp_counts;
  a("grasps_closed", grasped.closed);
  a("grasps_empty", grasped.empty);
  a("grasped_points", grasped.points);
  a("grasped_area", grasped.area);
  a("largest_grasped_area", grasped.largest_area);
  a("queries", m.queries);
  a("query_seconds", m.query_seconds);
  contact::archive(a, "largest_jump", m.resultants.largest_jump);
  contact::archive(a, "largest_after", m.resultants.largest_after);
  a("largest_friction_lag", m.largest_friction_lag);
  a("largest_friction", m.largest_friction);
  if (!a.is_restoring()) return;
  m.query(state);
  m.check_samples(state);
}

}  // namespace palpate::contact
