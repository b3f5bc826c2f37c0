#include "motion.h"

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "palpate/loop/run.h"

namespace peers {
namespace {

class Recorder final : public loop::Observer {
 public:
  explicit Recorder(std::vector<Snapshot>& states) : states_(states) {}
  void period(loop::World& world, double time) override {
    const auto& samples = world.contact->samples();
    if (std::any_of(samples.begin(), samples.end(), [](const auto& s) { return s.gap < 0.0; }))
      states_.push_back({time, world.state.q(), world.state.u()});
  }

 private:
  std::vector<Snapshot>& states_;
};

}  // namespace

int Motion::triangles() const {
  int sum = 0;
  for (const loop::Body& b : world->bodies) sum += static_cast<int>(b.skin->rest.faces.cols());
  return sum;
}
int Motion::vertices() const {
  int sum = 0;
  for (const loop::Body& b : world->bodies) sum += static_cast<int>(b.skin->rest.vertices.cols());
  return sum;
}

Motion record_motion(const std::string& scene) {
  Motion out;
  out.description = loop::load(scene);
  out.description.integrator.threads = 1;
  out.description.record.reset();
  out.world = loop::assemble(out.description);
  if (out.world->bodies.size() != 2 || !out.world->bodies[0].skin || !out.world->bodies[1].skin ||
      !out.world->contact)
    fail("{}: a scene of two soft bodies with skins and a contact between them is needed", scene);
  Recorder recorder(out.states);
  loop::RunOptions options;
  options.observers = {&recorder};
  const loop::RunResult result = loop::run(*out.world, options);
  if (!result.status.ok()) fail("{}: {}", scene, result.status.message);
  if (out.states.empty()) fail("{}: the two bodies never touch", scene);
  return out;
}

SkinPositions::SkinPositions(const loop::World& world, const loop::Body& body)
    : body_(body), offset_(world.state.layout().find(body.block_id)->q_offset) {
  nodes_.resizeLike(body.rest.nodes);
}

const Points& SkinPositions::at(const Snapshot& state) {
  nodes_ = Eigen::Map<const Points>(state.q.data() + offset_, 3, nodes_.cols());
  mesh::evaluate(body_.skin->embedding, body_.rest.tets, nodes_, vertices_);
  return vertices_;
}

}  // namespace peers
