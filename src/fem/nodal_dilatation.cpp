#include "palpate/fem/nodal_dilatation.h"

#include <algorithm>

#include <Eigen/LU>

#include "averaging_sites.h"
#include "core/counters.h"
#include "core/polar.h"
#include "corotational.h"
#include "law.h"
#include "node_block.h"
#include "node_rings.h"
#include "palpate/core/error.h"
#include "palpate/fem/laws.h"
#include "stress.h"

// Volumetric locking: each linear tetrahedron imposes one constraint of volume as lambda -> inf. A mesh has
// five to six times as many tetrahedra as nodes, more constraints than the three degrees of freedom per node:
// it locks. Averages at the nodes impose one constraint per node. With theta_e = tr(R^T F) - 3
// (corotational.h),
//
//   theta_n = (1/V_n) sum_{e at n} (V_e/4) theta_e,   V_n = sum_{e at n} V_e/4,
//   E = (kappa/2) sum_n V_n theta_n^2,
//
// kappa = (1 - share) lambda. As d theta_e = R : dF (corotational.h: dR drops out),
//
//   dE = kappa sum_n theta_n sum_{e at n} (V_e/4) R : dF = sum_e V_e P_e : dF,   P_e = kappa theta*_e R,
//   theta*_e = mean of theta_n over the four nodes:
//
// the element's force with the average of averages in place of theta_e. Uniform strain has theta* = theta:
// the patch test is satisfied. P_e F^T is symmetric: no moment. A single tetrahedron has theta* = theta_e: it
// equals the element.
//
// In a body of several materials, averages are taken within each material: theta jumps where lambda does (the
// pressure is continuous across the interface), and an average over both sides would constrain the soft side
// to the dilatation of the stiff one. So n runs over sites, that is, pairs of a node and a material at it,
// V_n and kappa_n belong to the site, and theta*_e is the mean over the four sites at the corners of e. The
// equations above hold unchanged: each element's corners still have weights that sum to one over the
// element's material.
//
// Tangent. V_n d theta_n = sum_j b_nj . dx_j over the ring of n, b_nj = sum_{e at n and j} (V_e/4) R g_j, so
// that
//
//   K_ij = sum_n (kappa/V_n) b_ni b_nj^T + sum_{e at i and j} V_e [h_i]x C [h_j]x,   C = -kappa theta*_e G,
//   h = R g, G = d axl / dR of corotational.h.
//
// The first sum is positive semi-definite, of rank one per node. The second, kappa theta* dR, adds to
// SoftBody's -c dR and makes it exact; its twists have the eigenvalues 2 kappa theta*/(s_i + s_j). The
// projected tangent therefore includes C only where theta* > 0. The warped tangent omits it, since there
// C = mu I is the coupling at theta = 0.
//
// Damping (objective_damping.h) is analogous, with tau_e = tr E' = F : F' in place of theta_e:
//
//   P_d = kappa_d tau*_e F,   D_ij = sum_n (kappa_d/V_n) d_ni d_nj^T,   d_nj = sum (V_e/4) F g_j,
//   power = kappa_d sum_n V_n tau_n^2 >= 0,
//   by position (unsymmetric):  K_ij = sum_e V_e kappa_d tau*_e (g_i . g_j) I
//                                      + sum_n (kappa_d/V_n) d_ni l_nj^T,   l_nj = sum (V_e/4) F' g_j.

namespace palpate::fem {

using dynamics::BorderedMatrix;
using dynamics::StateView;

namespace {

/// The four shape function gradients of an element as columns.
using Gradients = Eigen::Matrix<double, 3, 4>;

}  // namespace

double kept_volumetric_share(const Material& material) {
  const double lambda = material.lambda();
  return lambda > material.mu() ? material.mu() / lambda : 1.0;
}

struct NodalDilatation::Impl {
  std::string name;
  SoftBodyOptions options;
  int block_id;
  RestElements elements;
  std::vector<int> material_of_element;  ///< empty: one material
  AveragingSites sites;
  NodeRings rings;
  struct Constants {
    Lame kept;             ///< elastic constants of the SoftBody [Pa]
    double kappa = 0.0;    ///< (1 - share) lambda [Pa]
    double kappa_d = 0.0;  ///< (1 - share) lambda_d [Pa s]
  };
  std::vector<Constants> constants;  ///< per material
  bool definite = false;
  std::vector<Mat3> F, R;    ///< per element, for the state of the last deform()
  VecX element, site, rate;  ///< element values; averages at the sites; averages of the rate
  std::vector<Vec3> rotated, deformed, moving;  ///< ring rows b, d, l of the tangents

  Impl(std::string n, const TetMesh& rest, const Materials& materials, const SoftBodyOptions& o, int id)
      : name(std::move(n)),
        options(o),
        block_id(id),
        elements(make_rest_elements(rest, fmt::format("body \"{}\"", name))),
        material_of_element(materials.of_element),
        sites(elements, materials),
        rings(elements, sites.of_corner(elements), sites.count(elements)) {
    check_law(options.law, options.tangent, true, fmt::format("body \"{}\"", name));
    check(materials, elements.count(), fmt::format("body \"{}\"", name).c_str());
    PALPATE_CHECK(
        options.volumetric_shares.empty() || options.volumetric_shares.size() == materials.list.size(),
        "{} volumetric shares for {} materials", options.volumetric_shares.size(), materials.list.size());
    set(materials.list);
    F.resize(count());
    R.resize(count());
    element = rate = VecX::Zero(elements.count());
    site = VecX::Zero(rings.site_count());
    rotated.resize(static_cast<std::size_t>(rings.entry_count()));
    deformed = moving = rotated;
  }

  void set(const std::vector<Material>& list) {
    constants.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      Constants& c = constants[i];
      c.kept = {list[i].mu(), options.share_of(i) * list[i].lambda()};
      c.kappa = list[i].lambda() - c.kept.lambda;
      c.kappa_d = list[i].stiffness_damping * c.kappa;
    }
  }
  std::size_t count() const { return elements.volume.size(); }
  const Constants& of_element(std::size_t e) const {
    return constants[material_of_element.empty() ? 0 : static_cast<std::size_t>(material_of_element[e])];
  }
  const Constants& of_site(int s) const {
    return constants[sites.material.empty()
                         ? 0
                         : static_cast<std::size_t>(sites.material[static_cast<std::size_t>(s)])];
  }
  const std::array<std::vector<int>, 4>& corners() const { return sites.of_corner(elements); }
  double site_volume(int s) const { return sites.volume_of(elements, s); }
  NodeBlock block(const StateView& state) const { return NodeBlock(state, block_id, elements.node_count()); }
  bool damped() const {
    return std::any_of(constants.begin(), constants.end(),
                       [](const Constants& c) { return c.kappa_d != 0.0; });
  }
  bool damped_by_position() const { return damped() && options.full_damping_tangent && !definite; }
  Tangent tangent() const { return definite ? Tangent::kProjected : options.tangent; }

  Gradients gradients(std::size_t e) const {
    Gradients g;
    g.rightCols<3>() = elements.gradients(e).transpose();
    g.col(0) = -g.rightCols<3>().rowwise().sum();
    return g;
  }
  Mat3 gradient_of(std::size_t e, const double* field) const {
    return elements.edges(e, field) * elements.gradients(e);
  }

  void deform(const double* x, bool rotations = true) {
    for (std::size_t e = 0; e < count(); ++e) {
      F[e] = gradient_of(e, x);
      if (rotations) R[e] = polar_decomposition(F[e]).R;
    }
  }

  /// Sets `site` to the averages of the element values value(e).
  template <class Value>
  void to_sites(const Value& value) {
    site.setZero();
    for (std::size_t e = 0; e < count(); ++e) {
      const double share = 0.25 * elements.volume[e] * value(e);
      for (const auto& corner : corners()) site[corner[e]] += share;
    }
    for (int s = 0; s < rings.site_count(); ++s)
      if (const double volume = site_volume(s); volume > 0.0) site[s] /= volume;
  }
  /// Computes value* of each element: the mean of its sites' averages.
  template <class Value>
  void average(const Value& value, VecX& out) {
    to_sites(value);
    for (std::size_t e = 0; e < count(); ++e) {
      double sum = 0.0;
      for (const auto& corner : corners()) sum += site[corner[e]];
      out[static_cast<Eigen::Index>(e)] = 0.25 * sum;
    }
  }
  /// Returns sum_s kappa_s V_s site_s^2; `kappa` selects kappa or kappa_d.
  double weighted_square(double Constants::*kappa) const {
    double sum = 0.0;
    for (int s = 0; s < rings.site_count(); ++s)
      sum += of_site(s).*kappa * site_volume(s) * site[s] * site[s];
    return sum;
  }
  /// Returns the values at the sites averaged to the nodes by volume.
  VecX at_nodes() const {
    if (sites.node.empty()) return site;
    VecX out = VecX::Zero(elements.node_count());
    for (int s = 0; s < rings.site_count(); ++s)
      out[sites.node_of(s)] +=
          site_volume(s) / elements.nodal_volume[static_cast<std::size_t>(sites.node_of(s))] * site[s];
    return out;
  }
  double dilatation(std::size_t e) const { return double_dot(R[e], F[e]) - 3.0; }
  double strain_rate_trace(std::size_t e, const double* v) const {
    return double_dot(F[e], gradient_of(e, v));
  }
  double star(const VecX& values, std::size_t e) const { return values[static_cast<Eigen::Index>(e)]; }

  /// out += scale V P g_a. The force on node 0 is minus the sum of the others, so that momentum is conserved
  /// to rounding.
  void scatter(std::size_t e, const Mat3& P, double scale, double* out) const {
    const Mat3 H = (scale * elements.volume[e]) * P * elements.gradients(e).transpose();
    for (std::size_t a = 1; a < 4; ++a)
      Eigen::Map<Vec3>(out + 3 * elements.node[a][e]) += H.col(static_cast<int>(a) - 1);
    Eigen::Map<Vec3>(out + 3 * elements.node[0][e]) -= H.rowwise().sum();
  }

  /// Returns C of the second sum; zero where the tangent omits it.
  Mat3 coupling(std::size_t e) const {
    const double c = -of_element(e).kappa * star(element, e);
    if (tangent() == Tangent::kWarped || (tangent() == Tangent::kProjected && c > 0.0)) return Mat3::Zero();
    bool clamped = false;  // the SoftBody counts it
    return rotation_coupling(Tangent::kExact, F[e], R[e], {0.5 * c, 0.0}, clamped);
  }

  /// rows[ring entry (n, j)] = sum of (V_e/4) M_e g_j
  template <class Matrix>
  void fill_rows(const Matrix& matrix, std::vector<Vec3>& rows) const {
    std::fill(rows.begin(), rows.end(), Vec3::Zero());
    for (std::size_t e = 0; e < count(); ++e) {
      const Gradients h = (0.25 * elements.volume[e]) * matrix(e) * gradients(e);
      for (int n = 0; n < 4; ++n)
        for (int j = 0; j < 4; ++j) rows[static_cast<std::size_t>(rings.entry(e, n, j))] += h.col(j);
    }
  }

  /// A += sum_n (scale kappa_n/V_n) left_ni right_nj^T
  void add_products(double scale, double Constants::*kappa, const std::vector<Vec3>& left,
                    const std::vector<Vec3>& right, dynamics::BlockSparse& A) const {
    for (int n = 0; n < rings.site_count(); ++n) {
      const double volume = site_volume(n), factor = scale * of_site(n).*kappa;
      if (!(volume > 0.0) || factor == 0.0) continue;
      const auto first = static_cast<std::size_t>(rings.begin(n));
      for (int i = 0; i < rings.size(n); ++i) {
        const Vec3 row = factor / volume * left[first + static_cast<std::size_t>(i)];
        for (int j = 0; j < rings.size(n); ++j)
          A.add(rings.slot(n, i, j), row * right[first + static_cast<std::size_t>(j)].transpose());
      }
    }
  }

  /// A += the blocks of one element, block(a, b)
  template <class Block>
  void add_element(std::size_t e, const Block& block, dynamics::BlockSparse& A) const {
    for (int a = 0; a < 4; ++a) {
      const int n = corners()[static_cast<std::size_t>(a)][e], first = rings.begin(n);
      for (int b = 0; b < 4; ++b)
        A.add(rings.slot(n, rings.entry(e, a, a) - first, rings.entry(e, a, b) - first), block(a, b));
    }
  }
};

NodalDilatation::NodalDilatation(std::string name, const TetMesh& rest, const Materials& materials,
                                 const SoftBodyOptions& options, int block_id)
    : impl_(std::make_unique<Impl>(std::move(name), rest, materials, options, block_id)) {
  counters::count("fem.nodal_dilatation");
}
void NodalDilatation::set_materials(const std::vector<Material>& materials) {
  PALPATE_CHECK(materials.size() == impl_->constants.size(), "{} materials given, expected {}",
                materials.size(), impl_->constants.size());
  for (const Material& material : materials) check(material, fmt::format("body \"{}\"", impl_->name).c_str());
  impl_->set(materials);
}
NodalDilatation::~NodalDilatation() = default;

std::string_view NodalDilatation::name() const { return impl_->name; }
void NodalDilatation::project_to_psd(bool on) { impl_->definite = on; }

dynamics::TermTraits NodalDilatation::traits() const {
  return {.stiff = true,
          .fast = false,
          .symmetric_tangent = !impl_->damped_by_position(),
          .has_tangent = true,
          .conservative = true};
}

void NodalDilatation::add_pattern(dynamics::PatternBuilder& pattern) const {
  impl_->rings.add_pattern(pattern.first_node(impl_->block_id), pattern);
}

void NodalDilatation::add_force(const StateView& state, VecX& f) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  double* force = f.data() + at.u_offset;
  m.deform(at.x);
  m.average([&](std::size_t e) { return m.dilatation(e); }, m.element);
  const bool damped = m.damped();
  if (damped) m.average([&](std::size_t e) { return m.strain_rate_trace(e, at.v); }, m.rate);
  for (std::size_t e = 0; e < m.count(); ++e) {
    Mat3 P = m.of_element(e).kappa * m.star(m.element, e) * m.R[e];
    if (damped) P += m.of_element(e).kappa_d * m.star(m.rate, e) * m.F[e];
    m.scatter(e, P, -1.0, force);
  }
}

void NodalDilatation::add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  m.rings.prepare(at.first_node, A.body);
  m.deform(at.x);
  if (m.damped()) m.fill_rows([&](std::size_t e) { return m.F[e]; }, m.deformed);
  if (d_scale != 0.0 && m.damped())
    m.add_products(d_scale, &Impl::Constants::kappa_d, m.deformed, m.deformed, A.body);
  if (k_scale == 0.0) return;
  m.fill_rows([&](std::size_t e) { return m.R[e]; }, m.rotated);
  m.add_products(k_scale, &Impl::Constants::kappa, m.rotated, m.rotated, A.body);
  m.average([&](std::size_t e) { return m.dilatation(e); }, m.element);
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Gradients h = m.R[e] * m.gradients(e);
    const Mat3 C = k_scale * m.elements.volume[e] * m.coupling(e);
    m.add_element(
        e, [&](int a, int b) -> Mat3 { return cross_matrix(h.col(a)) * C * cross_matrix(h.col(b)); }, A.body);
  }
  if (!m.damped_by_position()) return;
  m.average([&](std::size_t e) { return m.strain_rate_trace(e, at.v); }, m.rate);
  for (std::size_t e = 0; e < m.count(); ++e) {
    const Gradients g = m.gradients(e);
    const double scale = k_scale * m.of_element(e).kappa_d * m.elements.volume[e] * m.star(m.rate, e);
    m.add_element(
        e, [&](int a, int b) -> Mat3 { return scale * g.col(a).dot(g.col(b)) * Mat3::Identity(); }, A.body);
  }
  m.fill_rows([&](std::size_t e) { return m.gradient_of(e, at.v); }, m.moving);
  m.add_products(k_scale, &Impl::Constants::kappa_d, m.deformed, m.moving, A.body);
}

void NodalDilatation::apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                                    VecX& y) {
  Impl& m = *impl_;
  const NodeBlock at = m.block(state);
  const double* direction = x.data() + at.u_offset;
  double* out = y.data() + at.u_offset;
  m.deform(at.x);
  const auto spread = [&](const VecX& values, double scale, double Impl::Constants::*kappa,
                          const std::vector<Mat3>& along) {
    for (std::size_t e = 0; e < m.count(); ++e)
      m.scatter(e, m.star(values, e) * along[e], scale * m.of_element(e).*kappa, out);
  };
  if (d_scale != 0.0 && m.damped()) {
    m.average([&](std::size_t e) { return m.strain_rate_trace(e, direction); }, m.rate);
    spread(m.rate, d_scale, &Impl::Constants::kappa_d, m.F);
  }
  if (k_scale == 0.0) return;
  m.average([&](std::size_t e) { return double_dot(m.R[e], m.gradient_of(e, direction)); }, m.element);
  spread(m.element, k_scale, &Impl::Constants::kappa, m.R);
  m.average([&](std::size_t e) { return m.dilatation(e); }, m.element);
  for (std::size_t e = 0; e < m.count(); ++e)
    m.scatter(e, elastic_stress_change(m.gradient_of(e, direction), m.R[e], m.coupling(e), Lame{}), k_scale,
              out);
  if (!m.damped_by_position()) return;
  m.average([&](std::size_t e) { return double_dot(m.gradient_of(e, direction), m.gradient_of(e, at.v)); },
            m.rate);
  spread(m.rate, k_scale, &Impl::Constants::kappa_d, m.F);
  m.average([&](std::size_t e) { return m.strain_rate_trace(e, at.v); }, m.rate);
  for (std::size_t e = 0; e < m.count(); ++e)
    m.scatter(e, m.star(m.rate, e) * m.gradient_of(e, direction), k_scale * m.of_element(e).kappa_d, out);
}

double NodalDilatation::energy(const StateView& state) {
  Impl& m = *impl_;
  m.deform(m.block(state).x);
  m.to_sites([&](std::size_t e) { return m.dilatation(e); });
  return 0.5 * m.weighted_square(&Impl::Constants::kappa);
}

double NodalDilatation::dissipated_power(const StateView& state) {
  Impl& m = *impl_;
  if (!m.damped()) return 0.0;
  const NodeBlock at = m.block(state);
  m.deform(at.x, false);
  m.to_sites([&](std::size_t e) { return m.strain_rate_trace(e, at.v); });
  return m.weighted_square(&Impl::Constants::kappa_d);
}

VecX NodalDilatation::dilatations(const StateView& state) {
  Impl& m = *impl_;
  m.deform(m.block(state).x);
  m.to_sites([&](std::size_t e) { return m.dilatation(e); });
  return m.at_nodes();
}

VecX NodalDilatation::nodal_stress(const StateView& state) {
  Impl& m = *impl_;
  m.deform(m.block(state).x);
  m.average([&](std::size_t e) { return m.dilatation(e); }, m.element);
  m.to_sites([&](std::size_t e) {
    const Mat3 P = elastic_stress(m.F[e], m.R[e], m.of_element(e).kept) +
                   m.of_element(e).kappa * m.star(m.element, e) * m.R[e];
    return von_mises(P, m.F[e]);
  });
  return m.at_nodes();
}

}  // namespace palpate::fem
