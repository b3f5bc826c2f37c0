// A tool that slides sideways in a round dent, without friction: between two queries the normal of a region
// stands, and with it the lateral force; it is a spring that is read once a refresh.
//
// The normal of two round skins is the line of their centres.  In a dent of radius R_b, a ball of radius R_a
// has its centre D = R_b - R_a from the dent's, and a step s to the side turns the normal back by s / D: a
// lateral spring kappa = F / D.  Held over a refresh interval T, it moves a mass m by
//     x' = x + T v - kappa T^2/(2 m) x,   v' = v - kappa T/m x,
// a map of determinant 1 + kappa T^2/(2 m): with w^2 = kappa/m each refresh multiplies the energy by
//     1 + (w T)^2/2,    a cycle of 2 pi/(w T) refreshes by   exp(pi w T)  to first order:
// a negative damper of kappa T/2.  The hand's and the contact's own lateral dampers, b in sum, take more than
// that where
//     b > F T / (2 D),
// which for 5 N in a dent with D = 0.1 m at 10 ms is 0.25 N s/m, a hundredth of a virtual coupling's.
#include <map>

#include "backends.h"
#include "grid_proxies.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kBall = 1.0, kDent = 1.5, kDeep = 0.02, kStiffness = 1e5;

/// A soft ball that stays round, in a round dent that opens upwards; by proxies, so that the normal is the
/// overlap's.
struct Dent {
  dynamics::State state;
  Points at_rest;
  contact::ContactForce term;

  Dent() {
    const TetMesh ball = mesh::ball(kBall, 0.45);
    const TriMesh skin = mesh::sphere(kBall, 32);
    contact::NodeSurface surface;
    surface.embedding = mesh::embed(ball, skin.vertices);
    surface.faces = skin.faces;
    surface.tets = ball.tets;
    at_rest = ball.nodes;
    at_rest.row(2).array() -= kDent - kBall + kDeep;  // the dent's centre is the origin
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(at_rest.size());
    surface.block_id =
        state.insert(nodes, Eigen::Map<const VecX>(at_rest.data(), at_rest.size()), VecX::Zero(nodes.u_size));
    const auto proxies = proxies_of(ball, skin, surface.embedding, 2);
    const TriMesh dent = bowl();
    term.add_frame(contact::fixed_frame());
    contact::ImageOptions options;
    options.pixels = 160;
    options.candidate_gap = 0.02;
    ContactSpec law;
    law.stiffness_pa_m = kStiffness;
    term.add_pair(contact::make_image_source(surface, proxies, dent, proxies_of(dent), 0,
                                             contact::fixed_frame(), options),
                  law);
  }

  /// The lower part of a sphere of radius kDent about the origin, seen from within; closed by a cone below.
  static TriMesh bowl() {
    const TriMesh out = sphere(Vec3::Zero(), kDent, 72);
    std::vector<Eigen::Vector3i> kept;
    for (Eigen::Index f = 0; f < out.faces.cols(); ++f) {
      double top = -kDent;
      for (const int v : out.faces.col(f)) top = std::max(top, out.vertices(2, v));
      if (top < -0.6 * kDent) kept.emplace_back(out.faces(0, f), out.faces(2, f), out.faces(1, f));
    }
    return closed_by_cone(compact(out.vertices, kept), Vec3(0, 0, -kDent - 0.5));
  }
  /// Without the vertices that no face names.
  static TriMesh compact(const Points& vertices, const std::vector<Eigen::Vector3i>& faces) {
    std::map<int, int> index;
    for (const auto& face : faces)
      for (const int v : face) index.emplace(v, 0);
    TriMesh out{Points(3, static_cast<Eigen::Index>(index.size())),
                Faces(3, static_cast<Eigen::Index>(faces.size()))};
    int next = 0;
    for (auto& [old, now] : index) {
      now = next++;
      out.vertices.col(now) = vertices.col(old);
    }
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (int k = 0; k < 3; ++k) out.faces(k, static_cast<Eigen::Index>(f)) = index.at(faces[f][k]);
    return out;
  }

  /// Force on the ball where it is `x` to the side, by a fresh query.
  Vec3 force_at(double x) {
    Points moved = at_rest;
    moved.row(0).array() += x;
    state.q() = Eigen::Map<const VecX>(moved.data(), moved.size());
    term.refresh(state.view());
    return -term.frame_wrench(state.view(), 0).force;
  }
};

}  // namespace

// The lateral spring is F / D, and none of it is in the tangent.
TEST(LateralStiffness, OfADentIsReadAtQueriesAlone) {
  Dent dent;
  const double D = kDent - kBall + kDeep;
  for (const double x : {0.02, -0.03}) {
    const Vec3 force = dent.force_at(x);
    EXPECT_NEAR(-force.x() / (force.norm() * x / std::hypot(x, D)), 1.0, 0.05) << x;
    // n n^T: no more of the stiffness along n than a turned n shows
    const Vec3 n = force.normalized();
    VecX sideways = VecX::Zero(dent.state.layout().u_size), along = sideways, K_sideways = sideways,
         K_along = sideways;
    for (Eigen::Index i = 0; i < sideways.size(); i += 3) sideways[i] = 1.0, along.segment<3>(i) = n;
    dent.term.apply_tangent(dent.state.view(), 1.0, 0.0, sideways, K_sideways);
    dent.term.apply_tangent(dent.state.view(), 1.0, 0.0, along, K_along);
    const double stiffness = along.dot(K_along);
    EXPECT_GT(stiffness, force.norm() / D);
    EXPECT_NEAR(sideways.dot(K_sideways), n.x() * n.x() * stiffness, 1e-6 * stiffness) << x;
  }
}

// It adds energy as derived, and a lateral damper above kappa T/2 takes it.
TEST(LateralStiffness, ReadOnceARefreshAddsEnergyAsDerived) {
  constexpr double kAngle = 0.15, kStart = 0.02;  // w T
  constexpr int kRefreshes = 84;                  // two cycles
  Dent dent;
  const double kappa = -dent.force_at(kStart).x() / kStart, mass = kappa / (kAngle * kAngle);  // T = 1
  // growth of the energy x^2 kappa/2 + m v^2/2 with a damper that is `share` of kappa T/2
  const auto growth = [&](double share) {
    const double rate = share * 0.5 * kappa / mass;
    double x = kStart, v = 0.0;
    const auto energy = [&] { return 0.5 * kappa * x * x + 0.5 * mass * v * v; };
    const double before = energy();
    for (int i = 0; i < kRefreshes; ++i) {
      // over one interval m v' = F - b v with F held
      const double F = dent.force_at(x).x() / mass;
      if (rate == 0.0) {
        x += v + 0.5 * F;
        v += F;
      } else {
        const double left = std::exp(-rate), limit = F / rate, fast = v - limit;
        x += limit + fast * (1.0 - left) / rate;
        v = limit + fast * left;
      }
    }
    return energy() / before;
  };
  const double undamped = std::pow(1.0 + 0.5 * kAngle * kAngle, kRefreshes);
  EXPECT_NEAR(growth(0.0) / undamped, 1.0, 0.1);
  EXPECT_GT(undamped, 2.0);
  EXPECT_NEAR(growth(1.0), 1.0, 0.1) << "just taken";
  EXPECT_LT(growth(2.0), 0.6);
}
