// palpate's contact by nearest points, from positions of nodes to forces on nodes. It receives no motion of
// the skins: it bounds the motion by data kept from query to query.
#include "contact/sources.h"
#include "contender.h"
#include "distance/skin_contact.h"

namespace peers {
namespace {

distance::Skin skin_of(const loop::Body& body) {
  return distance::make_skin(body.skin->rest, body.skin->embedding, body.rest.tets,
                             static_cast<int>(body.rest.nodes.cols()));
}

std::array<double, 2> spacing_of(const Motion& motion, double error) {
  const auto a = contact::lengths_of(motion.body(0).skin->rest),
             b = contact::lengths_of(motion.body(1).skin->rest);
  return {contact::point_spacing(a, b, error), contact::point_spacing(b, a, error)};
}

class Distance final : public Contender {
 public:
  Distance(const Motion& motion, double error)
      : error_(error),
        a_(skin_of(motion.body(0))),
        b_(skin_of(motion.body(1))),
        contact_(a_, b_,
                 {.stiffness_pa_m = motion.description.contacts.front().stiffness_pa_m,
                  .spacing_m = spacing_of(motion, error)}) {
    for (int k = 0; k < 2; ++k)
      offsets_[k] = motion.world->state.layout().find(motion.body(k).block_id)->q_offset;
    forces_[0].setZero(3 * a_.node_count);
    forces_[1].setZero(3 * b_.node_count);
  }
  std::string group() const override { return "nearest points"; }
  std::string name() const override { return fmt::format("error {:.0e}", error_); }
  void query(const Snapshot& state) override {
    contact_.find(state.q.data() + offsets_[0], state.q.data() + offsets_[1]);
    for (VecX& f : forces_) f.setZero();
    contact_.add_force(forces_[0].data(), forces_[1].data());
  }
  Found found() const override { return {static_cast<long>(contact_.springs().size()), contact_.deepest()}; }

 private:
  double error_;
  distance::Skin a_, b_;
  distance::SkinContact contact_;
  int offsets_[2] = {};
  VecX forces_[2];
};

}  // namespace

void add_distance(const Motion& motion, Contenders& to) {
  for (const double error : {1e-2, 1e-3}) to.push_back(std::make_unique<Distance>(motion, error));
}

}  // namespace peers
