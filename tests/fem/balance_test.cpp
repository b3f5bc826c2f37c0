#include <numeric>

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

struct Shaken {
  TetMesh rest = jittered_cube(3, 0.15, 21);
  VecX x, v;
  SoftBody body;
  explicit Shaken(double stiffness_damping) : body("b", rest, material(stiffness_damping), {}, 0) {
    Random random(22);
    x = flat(random.rotation() * rest.nodes) + 0.1 * random.vector(3 * rest.nodes.cols());
    v = random.vector(x.size());
  }
  static Material material(double beta) {
    Material m = soft_material();
    m.stiffness_damping = beta;
    return m;
  }
  VecX force(const VecX& at_x, const VecX& at_v) {
    OneBody at(at_x, at_v);
    VecX f = VecX::Zero(at_x.size());
    body.add_force(at.state.view(), f);
    return f;
  }
  double power(const VecX& at_x, const VecX& at_v) {
    const OneBody at(at_x, at_v);
    return body.dissipated_power(at.state.view());
  }
  double energy(const VecX& at_x) {
    const OneBody at(at_x, VecX::Zero(at_x.size()));
    return body.energy(at.state.view());
  }
};

VecX spin(const VecX& x, const Vec3& omega) { return flat(cross_matrix(omega) * unflat(x)); }

}  // namespace

TEST(Balance, InternalAndDampingForcesHaveNoResultantAndNoMoment) {
  for (double beta : {0.0, 0.5}) {
    Shaken s(beta);
    expect_balanced(unflat(s.force(s.x, s.v)), unflat(s.x));
  }
}

TEST(Balance, DampingDoesNotBrakeARigidMotion) {
  Shaken s(0.5), elastic(0.0);
  const VecX rigid = spin(s.x, {1.0, -2.0, 3.0}) + flat(Vec3(4, 5, 6).replicate(1, s.x.size() / 3));
  const double deforming = s.power(s.x, s.v);
  EXPECT_LT(s.power(s.x, rigid), 1e-12 * deforming);
  const VecX undamped = elastic.force(s.x, rigid);
  EXPECT_LT((s.force(s.x, rigid) - undamped).norm(), 1e-12 * undamped.norm());
}

TEST(Balance, DampingTakesPowerOutOfAnyOtherMotion) {
  Shaken s(0.5), elastic(0.0);
  Random random(23);
  for (int i = 0; i < 20; ++i) {
    const VecX x = s.x + 0.3 * random.vector(s.x.size()), v = random.vector(s.x.size());
    const double power = s.power(x, v);
    EXPECT_GT(power, 0.0);
    // power of the damping force
    EXPECT_NEAR(-(s.force(x, v) - elastic.force(x, v)).dot(v), power, 1e-12 * power);
  }
}

TEST(Balance, MassDampingBrakesWithTheMomentum) {
  const TetMesh rest = jittered_cube(1, 0.1, 24);
  Material m = soft_material();
  m.mass_damping = 0.7;
  SoftBody body("b", rest, m, {}, 0);
  const Vec3 velocity(1, 2, 3);
  const VecX x = flat(rest.nodes), v = flat(velocity.replicate(1, rest.nodes.cols()));
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  body.add_force(at.state.view(), f);
  const double mass = lumped_masses(rest, m.density).sum();
  EXPECT_LT((unflat(f).rowwise().sum() + 0.7 * mass * velocity).norm(), 1e-13 * mass);
  EXPECT_NEAR(body.dissipated_power(at.state.view()), 0.7 * mass * velocity.squaredNorm(),
              1e-13 * mass * velocity.squaredNorm());
}

TEST(Balance, RotationAndTranslationChangeNeitherEnergyNorTurnedForce) {
  Shaken s(0.5);
  Random random(25);
  const Mat3 Q = random.rotation();
  const Vec3 shift(0.3, -2.0, 1.1);
  const VecX x = flat((Q * unflat(s.x)).colwise() + shift), v = flat(Q * unflat(s.v));
  EXPECT_NEAR(s.energy(x), s.energy(s.x), 1e-13 * s.energy(s.x));
  const VecX expected = flat(Q * unflat(s.force(s.x, s.v)));
  EXPECT_LT((s.force(x, v) - expected).norm(), 1e-12 * expected.norm());
}

TEST(Balance, RestShapeHasNoEnergyNoForceNoStress) {
  Shaken s(0.0);
  Random random(26);
  const VecX x = flat((random.rotation() * s.rest.nodes).colwise() + Vec3(1, 2, 3)),
             zero = VecX::Zero(x.size());
  EXPECT_LT(s.energy(x), 1e-26);
  EXPECT_LT(s.force(x, zero).norm(), 1e-13);
  const OneBody at(x, zero);
  EXPECT_LT(s.body.nodal_stress(at.state.view()).maxCoeff(), 1e-12);
}

TEST(Balance, RenumberingNodesAndElementsPermutesTheResult) {
  Shaken s(0.5);
  const auto n = s.rest.nodes.cols();
  std::vector<int> place(static_cast<std::size_t>(n));
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), std::mt19937(27));
  TetMesh renumbered = s.rest;
  VecX x = s.x, v = s.v;
  for (int i = 0; i < n; ++i) {
    const int to = place[static_cast<std::size_t>(i)];
    renumbered.nodes.col(to) = s.rest.nodes.col(i);
    x.segment<3>(3 * to) = s.x.segment<3>(3 * i);
    v.segment<3>(3 * to) = s.v.segment<3>(3 * i);
  }
  for (Eigen::Index e = 0; e < s.rest.tets.cols(); ++e) {
    const auto from = s.rest.tets.col(s.rest.tets.cols() - 1 - e);
    const int even[4] = {from[1], from[2], from[0], from[3]};  // an even permutation keeps the volume's sign
    for (int a = 0; a < 4; ++a) renumbered.tets(a, e) = place[static_cast<std::size_t>(even[a])];
  }
  SoftBody body("b", renumbered, s.body.materials()[0], {}, 0);
  OneBody at(x, v);
  VecX f = VecX::Zero(x.size());
  body.add_force(at.state.view(), f);
  const VecX expected = s.force(s.x, s.v);
  double error = 0.0;
  for (int i = 0; i < n; ++i)
    error +=
        (f.segment<3>(3 * place[static_cast<std::size_t>(i)]) - expected.segment<3>(3 * i)).squaredNorm();
  EXPECT_LT(std::sqrt(error), 1e-12 * expected.norm());
}
