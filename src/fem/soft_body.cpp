#include "palpate/fem/soft_body.h"

#include <utility>

#include <Eigen/LU>

#include "element_evaluation.h"
#include "node_block.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "stress.h"

namespace palpate::fem {

using dynamics::BorderedMatrix;
using dynamics::StateView;

struct SoftBody::Impl {
  std::string name;
  SoftBodyOptions options;
  int block_id;
  ElementEvaluation elements;
  Material material;
  ElementCounts counts;
  bool definite = false;  ///< the projected tangent in place of the named one

  Impl(std::string body, const TetMesh& rest, const SoftBodyOptions& opts, int block)
      : name(std::move(body)), options(opts), block_id(block),
        elements(rest, make_rest_elements(rest, fmt::format("body \"{}\"", name)), opts.full_damping_tangent) {}

  int node_count() const { return elements.chunks().node_count(); }
  NodeBlock place(const StateView& state) const { return NodeBlock(state, block_id, node_count()); }
  double mass(int node) const { return material.density * elements.chunks().nodal_volume[static_cast<std::size_t>(node)]; }
  bool damped() const { return material.stiffness_damping > 0.0; }

  ElementModel model(double k_scale, double d_scale) const {
    ElementModel m;
    m.mu = material.mu();
    m.lambda = options.volumetric_share * material.lambda();
    m.damping_mu = material.stiffness_damping * m.mu;
    m.damping_lambda = material.stiffness_damping * m.lambda;
    m.projected = definite || options.tangent == Tangent::kProjected;
    m.warped = !m.projected && options.tangent == Tangent::kWarped;
    m.by_position = damped() && options.full_damping_tangent && !definite && k_scale != 0.0;
    m.k_scale = k_scale;
    m.d_scale = d_scale;
    return m;
  }
  /// Whether a tangent of these scales needs the elements at all.
  bool acts(double k_scale, double d_scale) const { return k_scale != 0.0 || (d_scale != 0.0 && damped()); }

  void add_drag(const NodeBlock& at, double* force) const {
    for (int i = 0; i < node_count(); ++i) Eigen::Map<Vec3>(force + 3 * i) -= material.mass_damping * mass(i) * Eigen::Map<const Vec3>(at.v + 3 * i);
  }

  void set(const Material& m) {
    check(m, fmt::format("body \"{}\"", name).c_str());
    material = m;
  }
};

SoftBody::SoftBody(std::string name, const TetMesh& rest, const Material& material, const SoftBodyOptions& options, int block_id)
    : impl_(std::make_unique<Impl>(std::move(name), rest, options, block_id)) {
  counters::count("fem.soft_body");
  impl_->set(material);
  if (!options.instructions.empty()) {
    const LaneKernels* kernels = find_kernels(options.instructions.c_str());
    if (kernels == nullptr)
      fail("body \"{}\": this build or this processor has no instructions \"{}\"; baseline, avx2 and avx512 exist", impl_->name, options.instructions);
    impl_->elements.use(*kernels);
  }
}
SoftBody::~SoftBody() = default;

std::string_view SoftBody::name() const { return impl_->name; }
const ElementCounts& SoftBody::counts() const { return impl_->counts; }
void SoftBody::reset_counts() { impl_->counts = {}; }
const Material& SoftBody::material() const { return impl_->material; }
void SoftBody::set_material(const Material& material) { impl_->set(material); }
int SoftBody::node_count() const { return impl_->node_count(); }
int SoftBody::element_count() const { return impl_->elements.chunks().element_count(); }
std::string_view SoftBody::instructions() const { return impl_->elements.kernels().name; }
MemoryUse SoftBody::memory() const {
  return {impl_->elements.chunks().bytes(), impl_->elements.map_bytes(), impl_->elements.scratch_bytes()};
}

dynamics::TermTraits SoftBody::traits() const {
  const bool symmetric = !impl_->model(1.0, 1.0).by_position;
  return {.stiff = true, .fast = false, .symmetric_tangent = symmetric, .has_tangent = true, .conservative = true, .balanced = symmetric};
}

void SoftBody::set_definite(bool definite) { impl_->definite = definite; }

dynamics::Finding SoftBody::inspect(const StateView& state) const {
  const NodeBlock at = impl_->place(state);
  dynamics::Finding worst;
  impl_->elements.chunks().for_each([&](const ElementChunks::Element& e) {
    const double volume_ratio = (e.edges(at.x) * e.gradients).determinant();
    if (volume_ratio < worst.measure || (volume_ratio == worst.measure && e.number > worst.element)) worst = {e.number, volume_ratio};
  });
  return worst;
}

void SoftBody::add_pattern(dynamics::PatternBuilder& pattern) const {
  const int first_node = pattern.first_node(impl_->block_id);
  impl_->elements.chunks().for_each([&](const ElementChunks::Element& e) {
    int nodes[4];
    for (int a = 0; a < 4; ++a) nodes[a] = first_node + e.node[a];
    pattern.add_clique(nodes, 4);
  });
}
std::uint64_t SoftBody::pattern_version() const { return 1; }  // rest connectivity never changes

void SoftBody::add_force(const StateView& state, VecX& f) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double* force = f.data() + at.u_offset;
  const LaneCounts met = m.elements.add_force(m.model(0.0, 0.0), {at.x, m.damped() ? at.v : nullptr}, force);
  m.counts.inverted += met.inverted;
  m.counts.by_scalar += met.by_scalar;
  if (m.material.mass_damping > 0.0) m.add_drag(at, force);
}

void SoftBody::add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  if (m.acts(k_scale, d_scale)) {
    const ElementModel model = m.model(k_scale, d_scale);
    const LaneCounts met = m.elements.add_tangent(model, {at.x, model.by_position ? at.v : nullptr}, at.first_node, A.body);
    m.counts.clamped += met.clamped;
    m.counts.by_scalar += met.by_scalar;
  }
  if (d_scale == 0.0 || m.material.mass_damping == 0.0) return;
  m.elements.prepare(at.first_node, A.body);
  for (int i = 0; i < node_count(); ++i) A.body.add(m.elements.diagonal(i), d_scale * m.material.mass_damping * m.mass(i) * Mat3::Identity());
}

void SoftBody::apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  const double* direction = x.data() + at.u_offset;
  double* out = y.data() + at.u_offset;
  if (m.acts(k_scale, d_scale)) {
    const ElementModel model = m.model(k_scale, d_scale);
    m.counts.by_scalar += m.elements.apply_tangent(model, {at.x, model.by_position ? at.v : nullptr, direction}, out).by_scalar;
  }
  if (d_scale == 0.0 || m.material.mass_damping == 0.0) return;
  for (int i = 0; i < node_count(); ++i)
    Eigen::Map<Vec3>(out + 3 * i) += d_scale * m.material.mass_damping * m.mass(i) * Eigen::Map<const Vec3>(direction + 3 * i);
}

void SoftBody::add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f, dynamics::BalancedMatrix& A) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double* force = f.data() + at.u_offset;
  const LaneCounts met = m.elements.add_step(m.model(A.scale * k_scale, A.scale * d_scale), {at.x, m.damped() ? at.v : nullptr, shift.data() + at.u_offset},
                                             at.first_node, force, A);
  m.counts.inverted += met.inverted;
  m.counts.clamped += met.clamped;
  m.counts.by_scalar += met.by_scalar;
  if (m.material.mass_damping == 0.0) return;
  m.add_drag(at, force);
  for (int i = 0; i < node_count(); ++i) A.diagonal.segment<3>(at.u_offset + 3 * i).array() += d_scale * m.material.mass_damping * m.mass(i);
}

double SoftBody::energy(const StateView& state) { return impl_->elements.energy(impl_->model(0.0, 0.0), {impl_->place(state).x}); }

double SoftBody::dissipated_power(const StateView& state) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double sum = m.damped() ? m.elements.dissipated_power(m.model(0.0, 0.0), {at.x, at.v}) : 0.0;
  for (int i = 0; i < node_count(); ++i) sum += m.material.mass_damping * m.mass(i) * Eigen::Map<const Vec3>(at.v + 3 * i).squaredNorm();
  return sum;
}

VecX SoftBody::nodal_stress(const StateView& state) const {
  const ElementModel model = impl_->model(0.0, 0.0);
  return nodal_von_mises(impl_->elements.chunks(), impl_->place(state).x, {model.mu, model.lambda});
}

}  // namespace palpate::fem
