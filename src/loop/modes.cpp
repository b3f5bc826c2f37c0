#include "loop/modes.h"

#include "palpate/core/error.h"
#include "palpate/store/run_file.h"
#include "palpate/tool/tool.h"
#include "store/provenance.h"

namespace palpate::loop {
namespace {

/// Returns the longest edge of the bounding box of all bodies [m].
double size_of(const World& world) {
  Eigen::AlignedBox3d box;
  for (const Body& body : world.bodies)
    for (const auto& x : body.placed.colwise()) box.extend(Vec3(x));
  return box.sizes().maxCoeff();
}

/// Returns the factor that makes a shape visible.
double scale_of(const World& world, const VecX& shape) {
  double largest = 0.0;
  for (const Body& body : world.bodies) {
    const dynamics::Block& block = *world.state.layout().find(body.block_id);
    const Eigen::Map<const Points> nodes(shape.data() + block.u_offset, 3, body.placed.cols());
    largest = std::max(largest, nodes.colwise().norm().maxCoeff());
  }
  // A mode of the tool alone moves no body.
  return largest > 0.0 ? kModeAmplitude * size_of(world) / largest : 0.0;
}

}  // namespace

modes::Modes find_modes(World& world, int count) {
  if (world.bodies.empty())
    fail("{}: modes are computed for soft bodies, but the scene has no [[body]]", world.description.path);
  if (world.contact) world.refresh_contact();
  return modes::find_modes(world.system, world.state.view(), {count});
}

Points displaced(const World& world, const Body& body, const modes::Modes& modes, int mode) {
  const VecX shape = modes.shapes.col(mode);
  const dynamics::Block& block = *world.state.layout().find(body.block_id);
  return world.positions(body) +
         scale_of(world, shape) *
             Eigen::Map<const Points>(shape.data() + block.u_offset, 3, body.placed.cols());
}

void write_modes(World& world, const modes::Modes& modes, const std::string& path) {
  std::vector<store::RunPart> parts;
  Eigen::Index count = 0;
  for (const Body& body : world.bodies) {
    const Points positions = world.positions(body);
    parts.push_back({body.name, positions, body.file_tets(), {}});
    parts.back().reference(Eigen::all, body.file_node) = positions;
    count += body.placed.cols();
  }
  const scene::Description& d = world.description;
  store::RunFile file(path, parts,
                      store::RunInfo{d.name, d.source, store::provenance().version, modes.count()});
  Points points(3, count), velocity(3, count);
  VecX stress(count), q = world.state.q();
  const VecX still = VecX::Zero(world.state.u().size());
  for (int mode = 0; mode < modes.count(); ++mode) {
    q = world.state.q();
    for (const Body& body : world.bodies) {
      const dynamics::Block& block = *world.state.layout().find(body.block_id);
      Eigen::Map<Points>(q.data() + block.q_offset, 3, body.placed.cols()) =
          displaced(world, body, modes, mode);
    }
    const dynamics::StateView view = world.state.view(world.state.time(), q.data(), still.data());
    Eigen::Index first = 0;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      const Eigen::Index n = body.placed.cols();
      const dynamics::Block& block = *world.state.layout().find(body.block_id);
      points.middleCols(first, n)(Eigen::all, body.file_node) =
          Eigen::Map<const Points>(q.data() + block.q_offset, 3, n);
      velocity.middleCols(first, n) = modes.omega(mode) * (points.middleCols(first, n) - parts[i].reference);
      stress.segment(first, n)(body.file_node) = body.nodal_stress(view);
      first += n;
    }
    file.append(mode + 1.0, points, velocity, stress);
  }
  file.close();
}

}  // namespace palpate::loop
