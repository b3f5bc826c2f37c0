#include "modal_body.h"

#include <algorithm>

#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/rigid_body.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate::validation {

void ModalBody::hold(const std::string& axes, const std::function<bool(const Vec3&)>& where) {
  for (int i = 0; i < rest.nodes.cols(); ++i)
    if (where(rest.nodes.col(i)))
      for (const char axis : axes) held.push_back(3 * i + (axis - 'x'));
}

namespace {

void add_bone(const ModalBody& body, dynamics::State& state, dynamics::System& system) {
  const Vec3 at = body.bone_centre;
  const VecX q = (VecX(7) << 1.0, 0.0, 0.0, 0.0, at).finished();
  const int bone = state.insert(dynamics::rigid_block("bone", 1.0, 1.0), q, VecX::Zero(6));
  const double factor = body.defect.bone_mass;
  system.add(dynamics::make_rigid_inertia(bone, factor * body.bone_mass, factor * body.bone_inertia));
  Points local(3, 3 * static_cast<Eigen::Index>(body.carried.size()));
  for (Eigen::Index i = 0; i < local.cols(); ++i)
    local.col(i) = body.rest.nodes.col(body.carried[static_cast<std::size_t>(i / 3)]) - at;
  system.add(fem::make_carried(fem::dofs_of_nodes(body.carried, 0, "xyz"), local, bone));
}

}  // namespace

modes::Modes ModalBody::lowest(int count) const {
  dynamics::State state;
  dynamics::System system;
  dynamics::BlockSpec spec;
  spec.name = "body";
  spec.q_size = spec.u_size = static_cast<int>(rest.nodes.size());
  const VecX q0 = rest.nodes.reshaped();
  const int id = state.insert(spec, q0, VecX::Zero(q0.size()));
  const fem::Materials of_elements = defect.elements.value_or(materials()),
                       of_masses = defect.masses.value_or(materials());
  const auto elastic = std::make_shared<fem::SoftBody>("body", rest, of_elements, fem::SoftBodyOptions{}, id);
  if (defect.force != 1.0)
    system.add(scaled(elastic, {.force = defect.force}));
  else
    system.add(std::static_pointer_cast<dynamics::ForceTerm>(elastic));
  const auto mass = consistent_mass ? fem::make_consistent_mass(rest, of_masses, id)
                                    : fem::make_lumped_mass(rest, of_masses, id);
  system.add(defect.mass != 1.0 ? scaled(mass, defect.mass) : mass);
  if (consistent_mass) system.set_mass_solver(linear::make_linear_solver("cholmod"));
  std::vector<int> dofs = held;
  dofs.insert(dofs.end(), defect.held.begin(), defect.held.end());
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  if (!dofs.empty()) system.add(fem::make_fixed(dofs, q0(dofs)));
  if (!carried.empty()) add_bone(*this, state, system);
  system.prepare(state.view());
  modes::Modes modes = modes::find_modes(system, state.view(), {count});
  if (!modes.converged) fail("the modes of {} nodes did not converge", rest.nodes.cols());
  return modes;
}

double ModalBody::overlap(const VecX& f, const VecX& g) const {
  const VecX mass = fem::lumped_masses(rest, materials()).transpose().replicate(3, 1).reshaped();
  const double fg = f.dot(mass.cwiseProduct(g));
  return fg * fg / (f.dot(mass.cwiseProduct(f)) * g.dot(mass.cwiseProduct(g)));
}

VecX ModalBody::field(const std::function<Vec3(const Vec3&)>& displacement) const {
  VecX out(rest.nodes.size());
  for (int i = 0; i < rest.nodes.cols(); ++i) out.segment<3>(3 * i) = displacement(rest.nodes.col(i));
  return out;
}

Match best_match(const ModalBody& body, const modes::Modes& modes, const VecX& shape) {
  Match best;
  for (int j = 0; j < modes.count(); ++j)
    if (const double overlap = body.overlap(modes.shapes.col(j).head(shape.size()), shape);
        overlap > best.overlap)
      best = {j, overlap, modes.omega(j)};
  return best;
}

}  // namespace palpate::validation
