#include <Eigen/LU>
#include <cmath>

#include "cases.h"
#include "core/polar.h"
#include "faults.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/embedding.h"
#include "palpate/mesh/generators.h"
#include "pressed_block.h"
#include "statics.h"

// Problem: a soft round block with radius and depth L and a fixed bottom is dented by 0.35 L under a smooth
// rigid sphere with radius 0.6 L, in steps, and released in the same steps. No closed form exists: strains
// are of order one, the surface wraps around the tool, and the bottom affects the dent. Two properties are
// measured.
// - Energy: statics without friction is elastic. With F(s) the force at the depth s, the work of the tool
//   equals the energy stored in the block and in the contact springs,
//       int_0^d F ds = U(d)        (Gauss-Legendre: F is smooth except for s^(3/2) at the touch);
//   the force at each depth is the same on release, and at the end the block is at rest. U is summed here
//   from its definition,
//       sum of V (mu |F - R|^2 + lambda/2 tr(R^T F - 1)^2),
//   so that a force by another law, even a consistent one, does different work.
// - Convergence: the force converges with the cells with order 2, as the elements' energy does. The
//   reference is extrapolated with this order from 9 and 14 cells along L; the refinement sequence uses other
//   meshes. Meshes too coarse for the dent are too stiff by several per cent: this shows the mesh that such a
//   dent requires.
//
// Areas and normals of samples come from a query, and the block is queried until the force has converged, so
// that the force of the springs is the derivative of their energy except for the change of the areas, a
// part of the springs' energy. k L/E* = 200 makes this a few thousandths of the whole (limit on the
// work: 1e-2).
//
// On one mesh the force by material points, each along its line to the tool, is compared with the force at
// the vertices.

namespace palpate::validation {
namespace {

constexpr double kSize = 0.02, kTool = 0.6 * kSize, kDent = 0.35 * kSize;  // L, R, d [m]
constexpr double kYoung = 1e4, kPoisson = 0.3;
constexpr double kStiffness = 200.0 * kYoung / ((1.0 - kPoisson * kPoisson) * kSize);  // [Pa/m]

/// Frame whose height is set by the caller.
class Stand final : public contact::MovingFrame {
 public:
  Pose pose(const dynamics::StateView&) const override { return {Quat::Identity(), Vec3(0, 0, height)}; }
  Twist twist(const dynamics::StateView&) const override { return {}; }
  double height = 0.0;
};

/// Returns the top of the block as a skin, with each face divided into kParts^2. With the nodes alone as
/// samples the force would jump as successive rings of nodes come into contact.
TriMesh fine_top(const mesh::Boundary& boundary, double small) {
  constexpr int kParts = 5;
  TriMesh out;
  std::vector<Vec3> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const auto& face : boundary.surface.faces.colwise()) {
    const Mat3 x = boundary.surface.vertices(Eigen::all, face);
    if (x.row(2).minCoeff() < -small) continue;
    const auto first = static_cast<int>(vertices.size());
    const auto at = [&](int i, int j) { return first + i * (kParts + 1) - i * (i - 1) / 2 + j; };
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; j <= kParts - i; ++j)
        vertices.push_back((x.col(0) * (kParts - i - j) + x.col(1) * i + x.col(2) * j) / kParts);
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; j < kParts - i; ++j) {
        faces.emplace_back(at(i, j), at(i + 1, j), at(i, j + 1));
        if (j + 1 < kParts - i) faces.emplace_back(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  out.vertices =
      Eigen::Map<const Points>(vertices.front().data(), 3, static_cast<Eigen::Index>(vertices.size()));
  out.faces = Eigen::Map<const Faces>(faces.front().data(), 3, static_cast<Eigen::Index>(faces.size()));
  return out;
}

/// Block and tool.
class Dent {
 public:
  /// @param cells number of cells along L
  /// @param points contact by material points; otherwise exact gaps at the vertices of a fine skin
  Dent(int cells, bool points, const std::string& fault)
      : mesh_{kSize / std::sinh(std::log(2.0)), cells, 1, BlockShape::kRoundQuarter},
        rest_(mesh_.tets()),
        body_(rest_, material()) {
    const double small = 1e-3 * mesh_.smallest_cell();
    for (int i = 0; i < rest_.nodes.cols(); ++i) {
      const Vec3 x = rest_.nodes.col(i);
      if (x.z() < small - kSize) {
        body_.hold(i, x);
        continue;
      }
      for (int axis : {0, 1})
        if (std::abs(x[axis]) < small) body_.hold(i, axis, 0.0);
    }
    if (fault == "small-strain")
      body_.replace([&](const auto& term) { return small_strain(term, rest_.nodes.reshaped()); });
    if (fault == "energy-off") body_.replace([](const auto& term) { return scaled(term, {.energy = 1.05}); });
    contact_->add_frame(tool_);
    ContactSpec law;
    law.stiffness_pa_m = kStiffness;
    const mesh::Boundary boundary = mesh::boundary(rest_);
    body_.add([&](int block_id) {
      contact::NodeSurface surface{block_id, boundary.node_of_vertex, boundary.surface.faces};
      std::unique_ptr<contact::SampleSource> source;
      constexpr double kCandidates = 0.05 * kSize;
      if (points) {
        source = contact::make_sphere_source(
            contact::material_points(surface, boundary.surface.vertices, rest_, 0.3 * mesh_.smallest_cell()),
            0, tool_, Vec3::Zero(), kTool, kCandidates);
      } else {
        const TriMesh top = fine_top(boundary, small);
        const contact::NodeSurface skin{
            block_id, {}, top.faces, mesh::embed(rest_, top.vertices), rest_.tets};
        source = contact::make_sphere_source(skin, 0, tool_, Vec3::Zero(), kTool, kCandidates);
      }
      if (fault == "areas-forgotten")  // Springs per sample instead of per area.
        source = spoiled(std::move(source), [](auto& samples) {
          for (auto& s : samples) s.area = 1e-8 * kSize * kSize;
        });
      contact_->add_pair(std::move(source), law);
      return contact_;
    });
  }

  /// Returns the force of the whole block on the tool at a depth [N]; NaN if no equilibrium is found.
  double press(double depth) {
    constexpr int kQueries = 40;
    tool_->height = kTool - depth;
    double before = std::nan("");
    for (int i = 0; i < kQueries; ++i) {
      contact_->refresh(body_.view());
      if (!body_.solve()) return std::nan("");
      const double force = 4.0 * contact_->frame_wrench(body_.view(), 0).force.z();
      if (std::abs(force - before) <= kSettled * std::abs(force)) return force;
      before = force;
    }
    return std::nan("");
  }
  /// Returns the force of the whole dent, reached in few steps [N].
  double press_straight() {
    double force = 0.0;
    for (const double part : {0.4, 0.7, 1.0}) force = press(part * kDent);
    return force;
  }
  /// Returns the energy of block and springs as computed by the library [J].
  double stored() { return 4.0 * body_.elastic_energy(); }
  /// Returns the energy of the springs alone, and of the block by the definition of its energy [J].
  double in_springs() { return 4.0 * contact_->energy(body_.view()); }
  double by_definition() const {
    const fem::Material m = material();
    double sum = 0.0;
    for (const auto& tet : rest_.tets.colwise()) {
      Mat3 before, after;
      for (int a = 0; a < 3; ++a) {
        before.col(a) = rest_.nodes.col(tet[a + 1]) - rest_.nodes.col(tet[0]);
        after.col(a) = body_.position(tet[a + 1]) - body_.position(tet[0]);
      }
      const Mat3 F = after * before.inverse(), R = polar_decomposition(F).R;
      const double trace = (R.transpose() * F).trace() - 3.0;
      sum += before.determinant() / 6.0 * (m.mu() * (F - R).squaredNorm() + 0.5 * m.lambda() * trace * trace);
    }
    return 4.0 * sum;
  }
  /// Returns the largest displacement of a node from rest, divided by L.
  double distance_from_rest() const {
    double largest = 0.0;
    for (int i = 0; i < rest_.nodes.cols(); ++i) largest = std::max(largest, body_.displacement(i).norm());
    return largest / kSize;
  }

 private:
  static fem::Material material() {
    fem::Material m;
    m.youngs_modulus = kYoung;
    m.poissons_ratio = kPoisson;
    return m;
  }
  BlockMesh mesh_;
  TetMesh rest_;
  StaticBody body_;
  static constexpr double kSettled = 1e-8;  ///< Relative change of the force from one query to the next.
  std::shared_ptr<Stand> tool_ = std::make_shared<Stand>();
  std::shared_ptr<contact::ContactForce> contact_ = std::make_shared<contact::ContactForce>();
};

// Gauss-Legendre rule with eight points on [0, 1]; the full dent follows them.
constexpr int kSteps = 8;
constexpr double kPoint[kSteps] = {0.019855071751232, 0.101666761293187, 0.237233795041836,
                                   0.408282678752175, 0.591717321247825, 0.762766204958164,
                                   0.898333238706813, 0.980144928248768};
constexpr double kWeight[kSteps] = {0.050614268145188, 0.111190517226687, 0.156853322938944,
                                    0.181341891689181, 0.181341891689181, 0.156853322938944,
                                    0.111190517226687, 0.050614268145188};

double relative(double found, double exact) { return std::abs(found / exact - 1.0); }

/// Dents the block to the full depth through the points of the quadrature, and back.
void measure_work(const std::string& fault, std::vector<Measurement>& out) {
  Dent dent(6, false, fault);
  double work = 0.0, returned = 0.0, apart = 0.0;
  std::vector<double> forces;
  for (int i = 0; i < kSteps; ++i) {
    forces.push_back(dent.press(kPoint[i] * kDent));
    work += kWeight[i] * kDent * forces.back();
  }
  const double whole = dent.press(kDent), exact = dent.by_definition() + dent.in_springs(),
               stored = dent.stored(), springs = dent.in_springs() / exact;
  for (int i = kSteps; i-- > 0;) {
    const double back = dent.press(kPoint[i] * kDent);
    returned += kWeight[i] * kDent * back;
    const double off = std::abs(back - forces[static_cast<std::size_t>(i)]) / whole;
    if (!(off <= apart)) apart = off;  // Keeps a NaN.
  }
  dent.press(-0.1 * kSize);
  out.push_back({.quantity = "work of the tool against the energy of the dent by its definition [J]",
                 .computed = work,
                 .exact = exact,
                 .error = relative(work, exact),
                 .bar = 1e-2,
                 .note = fmt::format("6 cells along L; {:.1f} % of it in the springs", 100.0 * springs)});
  out.push_back({.quantity = "reported stored energy against its definition [J]",
                 .computed = stored,
                 .exact = exact,
                 .error = relative(stored, exact),
                 .bar = 1e-10});
  out.push_back({.quantity = "work returned during retraction [J]",
                 .computed = returned,
                 .exact = work,
                 .error = relative(returned, work),
                 .bar = 1e-6});
  out.push_back({.quantity = "force during retraction against indentation, largest difference / maximum "
                             "force",
                 .computed = apart,
                 .error = apart,
                 .bar = 1e-6});
  out.push_back({.quantity = "largest final displacement of a node from rest / L",
                 .computed = dent.distance_from_rest(),
                 .error = dent.distance_from_rest(),
                 .bar = 1e-9});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  measure_work(fault, out);
  if (!fault.empty() && fault != "areas-forgotten") return out;
  const auto force = [&](int cells, bool points) { return Dent(cells, points, fault).press_straight(); };
  const double fine = force(9, false), finest = force(14, false),
               limit = finest - (fine - finest) / (std::pow(14.0 / 9.0, 2) - 1.0);
  std::vector<double> h, errors;
  double last = 0.0;
  for (const int cells : {5, 7, 11}) {
    last = force(cells, false);
    h.push_back(1.0 / cells);
    errors.push_back(relative(last, limit));
  }
  out.push_back(
      {.quantity = "force of the whole dent, 11 cells, against the converged mesh [N]",
       .computed = last,
       .exact = limit,
       .error = errors.back(),
       .bar = 3e-2,
       .order = fitted_order(h, errors),
       .order_low = 1.7,
       .order_high = 2.4,
       .note = fmt::format("order over 5, 7, 11 cells; 9 and 14: {:.4f} and {:.4f} N", fine, finest),
       .refinement = {"cell / L", h, errors}});
  if (!fault.empty()) return out;
  const double by_points = force(9, true);
  out.push_back({.quantity = "material points: force of the whole dent against that of vertices, 9 cells [N]",
                 .computed = by_points,
                 .exact = fine,
                 .error = relative(by_points, fine),
                 .bar = 1e-2});
  return out;
}

}  // namespace

ValidationCase deep_dent() {
  return {
      .name = "deep-dent",
      .section = "C",
      .summary = "a soft block dented by 35 % of its radius by a rigid sphere: force, and returned work",
      .why =
          "objects may be dented this deeply, far beyond small-strain formulas; the force is compared with "
          "refined meshes and the energy with the work",
      .run = run,
      .faults = {{"small-strain", "work of the tool"},
                 {"energy-off", "reported stored energy"},
                 {"areas-forgotten", "force of the whole dent"}}};
}

}  // namespace palpate::validation
