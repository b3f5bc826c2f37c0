// palpate's contact by images, from positions of nodes to forces on nodes. A query is ContactForce::refresh,
// which finds the samples and compares the forces before and after, and one evaluation of the forces.
#include <algorithm>

#include "contender.h"

namespace peers {
namespace {

class Image final : public Contender {
 public:
  explicit Image(const Motion& motion) {
    scene::Description d = motion.description;
    for (ContactSpec& c : d.contacts) c.method = "image";
    world_ = loop::assemble(d);
  }
  std::string group() const override { return "palpate"; }
  std::string name() const override { return "image"; }
  void query(const Snapshot& state) override {
    const dynamics::StateView view =
        make_view(world_->state.layout(), state.time, state.q.data(), state.u.data());
    world_->contact->refresh(view);
    force_.setZero(state.u.size());
    world_->contact->add_force(view, force_);
  }
  Found found() const override {
    Found out;
    for (const contact::ContactSample& s : world_->contact->samples()) {
      out.contacts += s.gap < 0.0;
      out.deepest = std::max(out.deepest, -s.gap);
    }
    return out;
  }

 private:
  std::unique_ptr<loop::World> world_;
  VecX force_;
};

/// Common first stage of all other contenders.
class SkinsAlone final : public Contender {
 public:
  explicit SkinsAlone(const Motion& motion)
      : a_(*motion.world, motion.body(0)), b_(*motion.world, motion.body(1)) {}
  std::string group() const override { return ""; }
  std::string name() const override { return "skins from nodes alone"; }
  void query(const Snapshot& state) override { sum_ = a_.at(state)(0, 0) + b_.at(state)(0, 0); }
  Found found() const override { return {}; }

 private:
  SkinPositions a_, b_;
  double sum_ = 0.0;
};

}  // namespace

void add_image(const Motion& motion, Contenders& to) { to.push_back(std::make_unique<Image>(motion)); }

void add_skins_alone(const Motion& motion, Contenders& to) {
  to.push_back(std::make_unique<SkinsAlone>(motion));
}

}  // namespace peers
