#include "palpate/fem/soft_body.h"

#include <utility>

#include <Eigen/LU>

#include "corotated.h"
#include "node_block.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "palpate/core/polar.h"
#include "stress.h"

namespace palpate::fem {

using dynamics::BorderedMatrix;
using dynamics::StateView;

struct SoftBody::Impl {
  std::string name;
  SoftBodyOptions options;
  int block_id;
  RestElements elements;
  Material material;
  Lame elastic, damping;  ///< damping: beta (mu, lambda) [Pa s]
  ElementCounts counts;
  ScatterMap scatter;
  bool definite = false;  ///< the projected tangent in place of the named one

  Tangent tangent() const { return definite ? Tangent::kProjected : options.tangent; }
  bool damped() const { return damping.mu > 0.0; }
  bool damped_by_position() const { return damped() && options.full_damping_tangent && !definite; }
  std::size_t count() const { return elements.volume.size(); }
  NodeBlock place(const StateView& state) const { return NodeBlock(state, block_id, elements.node_count()); }
  double mass(std::size_t node) const { return material.density * elements.nodal_volume[node]; }

  void set(const Material& m) {
    check(m, fmt::format("body \"{}\"", name).c_str());
    material = m;
    elastic = {m.mu(), options.volumetric_share * m.lambda()};
    damping = {m.stiffness_damping * elastic.mu, m.stiffness_damping * elastic.lambda};
  }
};

namespace {

/// What every element evaluation begins with.
struct Deformation {
  Mat3 gradients, F, R;
  Deformation(const RestElements& elements, std::size_t e, const double* x)
      : gradients(elements.gradients(e)), F(elements.edges(e, x) * gradients), R(polar_decomposition(F).R) {}
};

/// Nodal forces -V P g_a; that of node 0 is minus the sum of the others, so that momentum is kept to rounding.
void scatter_force(const RestElements& elements, std::size_t e, const Mat3& gradients, const Mat3& P, double scale, double* f) {
  const Mat3 H = (scale * elements.volume[e]) * P * gradients.transpose();
  for (std::size_t a = 1; a < 4; ++a) Eigen::Map<Vec3>(f + 3 * elements.node[a][e]) += H.col(static_cast<int>(a) - 1);
  Eigen::Map<Vec3>(f + 3 * elements.node[0][e]) -= H.rowwise().sum();
}

}  // namespace

SoftBody::SoftBody(std::string name, const TetMesh& rest, const Material& material, const SoftBodyOptions& options, int block_id)
    : impl_(std::make_unique<Impl>()) {
  counters::count("fem.soft_body");
  impl_->name = std::move(name);
  impl_->options = options;
  impl_->block_id = block_id;
  impl_->elements = make_rest_elements(rest, fmt::format("body \"{}\"", impl_->name));
  impl_->set(material);
}
SoftBody::~SoftBody() = default;

std::string_view SoftBody::name() const { return impl_->name; }
const ElementCounts& SoftBody::counts() const { return impl_->counts; }
void SoftBody::reset_counts() { impl_->counts = {}; }
const Material& SoftBody::material() const { return impl_->material; }
void SoftBody::set_material(const Material& material) { impl_->set(material); }
int SoftBody::node_count() const { return impl_->elements.node_count(); }
int SoftBody::element_count() const { return impl_->elements.count(); }

dynamics::TermTraits SoftBody::traits() const {
  return {.stiff = true, .fast = false, .symmetric_tangent = !impl_->damped_by_position(), .has_tangent = true, .conservative = true};
}

void SoftBody::set_definite(bool definite) { impl_->definite = definite; }

dynamics::Finding SoftBody::inspect(const StateView& state) const {
  const Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  dynamics::Finding worst;
  for (std::size_t e = 0; e < m.count(); ++e) {
    const double volume_ratio = (m.elements.edges(e, at.x) * m.elements.gradients(e)).determinant();
    if (volume_ratio <= worst.measure) worst = {static_cast<int>(e), volume_ratio};
  }
  return worst;
}

void SoftBody::add_pattern(dynamics::PatternBuilder& pattern) const {
  add_element_pattern(impl_->elements, pattern.first_node(impl_->block_id), pattern);
}
std::uint64_t SoftBody::pattern_version() const { return 1; }  // rest connectivity never changes

void SoftBody::add_force(const StateView& state, VecX& f) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double* force = f.data() + at.u_offset;
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Deformation d(m.elements, e, at.x);
    if (d.F.determinant() <= 0.0) ++m.counts.inverted;
    Mat3 P = elastic_stress(d.F, d.R, m.elastic);
    if (m.damped()) P += d.F * damping_stress(strain_rate(d.F, m.elements.edges(e, at.v) * d.gradients), m.damping);
    scatter_force(m.elements, e, d.gradients, P, -1.0, force);
  }
  if (m.material.mass_damping > 0.0)
    for (int i = 0; i < node_count(); ++i)
      Eigen::Map<Vec3>(force + 3 * i) -= m.material.mass_damping * m.mass(static_cast<std::size_t>(i)) * Eigen::Map<const Vec3>(at.v + 3 * i);
}

void SoftBody::add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  m.scatter.prepare(m.elements, at.first_node, A.body);
  ElementBlocks blocks;
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Deformation d(m.elements, e, at.x);
    const double V = m.elements.volume[e];
    blocks.fill(Mat3::Zero());
    if (k_scale != 0.0) {
      bool clamped = false;
      const Mat3 C = rotation_coupling(m.tangent(), d.F, d.R, m.elastic, clamped);
      if (clamped) ++m.counts.clamped;
      add_elastic_blocks(d.gradients, d.R, C, m.elastic, k_scale * V, blocks);
      if (m.damped_by_position())
        add_damping_position_blocks(d.gradients, d.F, m.elements.edges(e, at.v) * d.gradients, m.damping, k_scale * V, blocks);
    }
    if (d_scale != 0.0 && m.damped()) add_damping_blocks(d.gradients, d.F, m.damping, d_scale * V, blocks);
    m.scatter.add(e, blocks, A.body);
  }
  if (d_scale == 0.0 || m.material.mass_damping == 0.0) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(node_count()); ++i)
    A.body.add(m.scatter.diagonal(i), d_scale * m.material.mass_damping * m.mass(i) * Mat3::Identity());
}

void SoftBody::apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) {
  Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  const double* direction = x.data() + at.u_offset;
  double* out = y.data() + at.u_offset;
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Deformation d(m.elements, e, at.x);
    const Mat3 dF = m.elements.edges(e, direction) * d.gradients;
    Mat3 dP = Mat3::Zero();
    if (k_scale != 0.0) {
      bool clamped = false;
      const Mat3 C = rotation_coupling(m.tangent(), d.F, d.R, m.elastic, clamped);
      dP += k_scale * elastic_stress_change(dF, d.R, C, m.elastic);
      if (m.damped_by_position()) {
        const Mat3 F_dot = m.elements.edges(e, at.v) * d.gradients;
        const Mat3 sigma = damping_stress(strain_rate(d.F, F_dot), m.damping);
        dP += k_scale * (dF * sigma + d.F * damping_stress(strain_rate(dF, F_dot), m.damping));
      }
    }
    if (d_scale != 0.0 && m.damped()) dP += d_scale * d.F * damping_stress(strain_rate(d.F, dF), m.damping);
    scatter_force(m.elements, e, d.gradients, dP, 1.0, out);
  }
  if (d_scale == 0.0 || m.material.mass_damping == 0.0) return;
  for (int i = 0; i < node_count(); ++i)
    Eigen::Map<Vec3>(out + 3 * i) += d_scale * m.material.mass_damping * m.mass(static_cast<std::size_t>(i)) * Eigen::Map<const Vec3>(direction + 3 * i);
}

double SoftBody::energy(const StateView& state) {
  const Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double sum = 0.0;
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Deformation d(m.elements, e, at.x);
    sum += m.elements.volume[e] * elastic_energy_density(d.F, d.R, m.elastic);
  }
  return sum;
}

double SoftBody::dissipated_power(const StateView& state) {
  const Impl& m = *impl_;
  const NodeBlock at = m.place(state);
  double sum = 0.0;
  if (m.damped())
    for (std::size_t e = 0; e < m.count(); ++e) {
      const Mat3 gradients = m.elements.gradients(e);
      const Mat3 rate = strain_rate(m.elements.edges(e, at.x) * gradients, m.elements.edges(e, at.v) * gradients);
      sum += m.elements.volume[e] * rate.cwiseProduct(damping_stress(rate, m.damping)).sum();
    }
  for (std::size_t i = 0; i < static_cast<std::size_t>(node_count()); ++i)
    sum += m.material.mass_damping * m.mass(i) * Eigen::Map<const Vec3>(at.v + 3 * i).squaredNorm();
  return sum;
}

VecX SoftBody::nodal_stress(const StateView& state) const {
  return nodal_von_mises(impl_->elements, impl_->place(state).x, impl_->elastic);
}

}  // namespace palpate::fem
