#include "palpate/fem/soft_body.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include <Eigen/LU>

#include "core/counters.h"
#include "element_evaluation.h"
#include "node_block.h"
#include "palpate/core/error.h"
#include "palpate/fem/laws.h"
#include "stress.h"

namespace palpate::fem {

using dynamics::BorderedMatrix;
using dynamics::StateView;

namespace {

const LaneKernels& kernels_of(const SoftBodyOptions& options, const std::string& where) {
  if (options.instructions.empty()) return best_kernels();
  const LaneKernels* kernels = find_kernels(options.instructions.c_str());
  if (kernels == nullptr)
    fail(
        "{}: instructions = \"{}\" is not supported by this build or this processor; the choices are "
        "baseline, avx2 and avx512",
        where, options.instructions);
  return *kernels;
}

std::size_t law_of(const SoftBodyOptions& options, const std::string& where) {
  const bool split = options.volumetric_share != 1.0 ||
                     std::any_of(options.volumetric_shares.begin(), options.volumetric_shares.end(),
                                 [](double share) { return share != 1.0; });
  check_law(options.law, options.tangent, split, where);
  return find_law(options.law, where);
}

std::string where(const std::string& name) { return fmt::format("body \"{}\"", name); }

}  // namespace

struct SoftBody::Impl {
  std::string name;
  SoftBodyOptions options;
  int block_id;
  std::size_t law;  ///< index in law_registry()
  ElementEvaluation elements;
  std::vector<Material> materials;
  std::uint64_t materials_version = 0;  ///< unique over all bodies
  ElementModels models;                 ///< per material, for the current evaluation
  VecX drag;                            ///< mass-proportional damping of each node [kg/s]; empty: none
  ElementCounts counts;
  bool definite = false;  ///< use the projected tangent whatever the options

  Impl(std::string body, const TetMesh& rest, const Materials& from, const SoftBodyOptions& opts, int block)
      : name(std::move(body)),
        options(opts),
        block_id(block),
        law(law_of(opts, where(name))),
        elements(rest, make_rest_elements(rest, where(name)), from.of_element, kernels_of(opts, where(name)),
                 law, opts.full_damping_tangent) {
    check(from, elements.chunks().element_count(), where(name).c_str());
    PALPATE_CHECK(options.volumetric_shares.empty() || options.volumetric_shares.size() == from.list.size(),
                  "{} volumetric shares for {} materials", options.volumetric_shares.size(),
                  from.list.size());
    set(from.list);
  }

  int node_count() const { return elements.chunks().node_count(); }
  NodeBlock block(const StateView& state) const { return NodeBlock(state, block_id, node_count()); }
  /// Whether any material has stiffness damping.
  bool damped() const {
    return std::any_of(materials.begin(), materials.end(),
                       [](const Material& m) { return m.stiffness_damping > 0.0; });
  }
  bool by_position() const { return damped() && options.full_damping_tangent && !definite; }

  const ElementModels& models_of(double k_scale, double d_scale) {
    for (std::size_t i = 0; i < materials.size(); ++i) {
      ElementModel& m = models[i];
      m.mu = materials[i].mu();
      m.lambda = options.share_of(i) * materials[i].lambda();
      m.damping_mu = materials[i].stiffness_damping * m.mu;
      m.damping_lambda = materials[i].stiffness_damping * m.lambda;
      m.projected = definite || options.tangent == Tangent::kProjected;
      m.warped = !m.projected && options.tangent == Tangent::kWarped;
      m.by_position = by_position() && k_scale != 0.0;
      m.k_scale = k_scale;
      m.d_scale = d_scale;
    }
    return models;
  }
  /// Whether a tangent with these scales has element contributions.
  bool acts(double k_scale, double d_scale) const { return k_scale != 0.0 || (d_scale != 0.0 && damped()); }

  bool dragged() const { return drag.size() > 0; }
  void add_drag(const NodeBlock& at, double* force) const {
    for (int i = 0; i < node_count(); ++i)
      Eigen::Map<Vec3>(force + 3 * i) -= drag[i] * Eigen::Map<const Vec3>(at.v + 3 * i);
  }

  /// The body's rows of A += (`stored`: =) k_scale K + d_scale D.
  void tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A, bool stored) {
    const NodeBlock at = block(state);
    if (acts(k_scale, d_scale)) {
      const BodyFields fields{at.x, by_position() && k_scale != 0.0 ? at.v : nullptr};
      const ElementModels& scaled = models_of(k_scale, d_scale);
      const LaneCounts met = stored ? elements.store_tangent(scaled, fields, at.first_node, A.body)
                                    : elements.add_tangent(scaled, fields, at.first_node, A.body);
      counts.clamped += met.clamped;
      counts.by_scalar += met.by_scalar;
    } else if (stored) {
      A.body.set_zero(at.first_node, node_count());
    }
    if (d_scale == 0.0 || !dragged()) return;
    elements.prepare(at.first_node, A.body);
    for (int i = 0; i < node_count(); ++i)
      A.body.add(elements.diagonal(i), d_scale * drag[i] * Mat3::Identity());
  }

  void set(const std::vector<Material>& list) {
    static std::atomic<std::uint64_t> sets{0};
    materials_version = ++sets;
    materials = list;
    models.resize(list.size());
    drag.resize(0);
    if (std::none_of(list.begin(), list.end(), [](const Material& m) { return m.mass_damping > 0.0; }))
      return;
    drag = VecX::Zero(node_count());
    if (list.size() == 1) {
      for (int i = 0; i < node_count(); ++i)
        drag[i] = list[0].mass_damping *
                  (list[0].density * elements.chunks().nodal_volume[static_cast<std::size_t>(i)]);
      return;
    }
    elements.chunks().for_each([&](const ElementChunks::Element& e) {
      const Material& m = list[static_cast<std::size_t>(e.material)];
      for (int node : e.node) drag[node] += m.mass_damping * m.density * 0.25 * e.volume;
    });
  }
};

SoftBody::SoftBody(std::string name, const TetMesh& rest, const Materials& materials,
                   const SoftBodyOptions& options, int block_id)
    : impl_(std::make_unique<Impl>(std::move(name), rest, materials, options, block_id)) {
  counters::count("fem.soft_body");
}
SoftBody::~SoftBody() = default;

std::string_view SoftBody::name() const { return impl_->name; }
const ElementCounts& SoftBody::counts() const { return impl_->counts; }
void SoftBody::reset_counts() { impl_->counts = {}; }
const std::vector<Material>& SoftBody::materials() const { return impl_->materials; }
void SoftBody::set_materials(const std::vector<Material>& materials) {
  PALPATE_CHECK(materials.size() == impl_->materials.size(), "{} materials given, expected {}",
                materials.size(), impl_->materials.size());
  for (const Material& material : materials) check(material, where(impl_->name).c_str());
  impl_->set(materials);
}
int SoftBody::node_count() const { return impl_->node_count(); }
int SoftBody::element_count() const { return impl_->elements.chunks().element_count(); }
std::string_view SoftBody::instructions() const { return impl_->elements.kernels().name; }
MemoryUse SoftBody::memory() const {
  return {impl_->elements.chunks().bytes(), impl_->elements.map_bytes(), impl_->elements.scratch_bytes()};
}

dynamics::TermTraits SoftBody::traits() const {
  return {.stiff = true,
          .fast = false,
          .symmetric_tangent = !impl_->by_position(),
          .has_tangent = true,
          .conservative = true};
}

void SoftBody::project_to_psd(bool on) { impl_->definite = on; }
bool SoftBody::fuses_step() const { return !impl_->by_position(); }
std::uint64_t SoftBody::step_version() const { return 2 * impl_->materials_version + impl_->definite; }

dynamics::Diagnostic SoftBody::inspect(const StateView& state) const {
  const NodeBlock at = impl_->block(state);
  dynamics::Diagnostic worst;
  impl_->elements.chunks().for_each([&](const ElementChunks::Element& e) {
    const double volume_ratio = (e.edges(at.x) * e.gradients).determinant();
    if (volume_ratio < worst.measure || (volume_ratio == worst.measure && e.number > worst.element))
      worst = {e.number, volume_ratio};
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
std::uint64_t SoftBody::pattern_version() const { return 1; }  // the rest connectivity never changes

void SoftBody::add_force(const StateView& state, VecX& f) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  double* force = f.data() + at.u_offset;
  const LaneCounts met =
      m.elements.add_force(m.models_of(0.0, 0.0), {at.x, m.damped() ? at.v : nullptr}, force);
  m.counts.inverted += met.inverted;
  m.counts.by_scalar += met.by_scalar;
  if (m.dragged()) m.add_drag(at, force);
}

void SoftBody::add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  impl_->tangent(state, k_scale, d_scale, A, false);
}

int SoftBody::stored_block() const { return impl_->block_id; }
void SoftBody::store_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  impl_->tangent(state, k_scale, d_scale, A, true);
}

void SoftBody::apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x, VecX& y) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  const double* direction = x.data() + at.u_offset;
  double* out = y.data() + at.u_offset;
  if (m.acts(k_scale, d_scale)) {
    m.counts.by_scalar +=
        m.elements
            .apply_tangent(m.models_of(k_scale, d_scale),
                           {at.x, m.by_position() && k_scale != 0.0 ? at.v : nullptr, direction}, out)
            .by_scalar;
  }
  if (d_scale == 0.0 || !m.dragged()) return;
  for (int i = 0; i < node_count(); ++i)
    Eigen::Map<Vec3>(out + 3 * i) += d_scale * m.drag[i] * Eigen::Map<const Vec3>(direction + 3 * i);
}

void SoftBody::add_step_force(const StateView& state, const VecX& shift, const VecX& change, VecX& f) {
  add_step_force_at_rate(state, shift, change, 0.0, f);
}

void SoftBody::add_step_force_at_rate(const StateView& state, const VecX& shift, const VecX& change,
                                      double rate, VecX& f) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  double* force = f.data() + at.u_offset;
  const double* more = change.data() + at.u_offset;
  const double* const v = m.damped() && rate == 0.0 ? at.v : nullptr;
  const LaneCounts met = m.elements.add_step_force(
      m.models_of(0.0, rate), {at.x, v, shift.data() + at.u_offset, v ? more : nullptr}, force);
  m.counts.inverted += met.inverted;
  m.counts.by_scalar += met.by_scalar;  // clamped is not counted: iterations apply this tangent repeatedly
  if (!m.dragged()) return;
  m.add_drag(at, force);
  for (int i = 0; i < node_count(); ++i)
    Eigen::Map<Vec3>(force + 3 * i) -= m.drag[i] * Eigen::Map<const Vec3>(more + 3 * i);
}

void SoftBody::add_step(const StateView& state, const VecX& shift, double k_scale, double d_scale, VecX& f,
                        dynamics::ZeroRowSumMatrix& A) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  double* force = f.data() + at.u_offset;
  const LaneCounts met = m.elements.add_step(m.models_of(A.scale * k_scale, A.scale * d_scale),
                                             {at.x, m.damped() ? at.v : nullptr, shift.data() + at.u_offset},
                                             at.first_node, force, A);
  m.counts.inverted += met.inverted;
  m.counts.clamped += met.clamped;
  m.counts.by_scalar += met.by_scalar;
  if (!m.dragged()) return;
  m.add_drag(at, force);
  for (int i = 0; i < node_count(); ++i)
    A.diagonal.segment<3>(at.u_offset + 3 * i).array() += d_scale * m.drag[i];
}

double SoftBody::energy(const StateView& state) {
  return impl_->elements.energy(impl_->models_of(0.0, 0.0), {impl_->block(state).x});
}

double SoftBody::dissipated_power(const StateView& state) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  double sum = m.damped() ? m.elements.dissipated_power(m.models_of(0.0, 0.0), {at.x, at.v}) : 0.0;
  for (int i = 0; m.dragged() && i < node_count(); ++i)
    sum += m.drag[i] * Eigen::Map<const Vec3>(at.v + 3 * i).squaredNorm();
  return sum;
}

VecX SoftBody::nodal_stress(const StateView& state) const {
  return impl_->elements.von_mises(impl_->models_of(0.0, 0.0), {impl_->block(state).x});
}

}  // namespace palpate::fem
