// A hand as a block of the State: tangents, power balance, opposite forces, friction.
#include "tool/hand_block.h"

#include <gtest/gtest.h>

#include <random>

#include "tool_fixtures.h"

using namespace palpate;
using namespace palpate::tool;
using namespace palpate::tool::testing;

namespace {

/// A tool and a hand in general position and motion, with the hand rotated by about a radian.
struct Pair {
  dynamics::State state{16, 16};
  int tool_id = -1, hand_id = -1;
  HandBlock hand;
  ToolSpec spec = spec_for("linearly-implicit-euler");
  HandTerms terms;

  explicit Pair(unsigned seed, double size = 1.0) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> in(-1.0, 1.0);
    const auto vec = [&](double scale) { return Vec3(scale * Vec3(in(rng), in(rng), in(rng))); };
    hand.translation = {0.8, 500.0, 5.0, 2.0, 0.7};
    hand.rotation = {1e-3, 2.0, 0.03, 0.01, 0.02};
    hand.requested = [turn = vec(0.4), rate = vec(0.2), x = vec(0.1), v = vec(0.3)](double t) {
      return HandleState{{quaternion_of(t * rate) * quaternion_of(turn), x + t * v}, {rate, v}};
    };
    VecX q(7), u(6);
    const Quat r = quaternion_of(vec(1.0));
    q << r.w(), r.vec(), vec(0.1);
    u << vec(5.0), vec(1.0);
    tool_id = state.insert(rigid_block("tool", 0.01, 0.1), q, u);
    VecX qh(6), uh(6);
    qh << vec(size), vec(0.1);
    uh << vec(3.0), vec(1.0);
    hand_id = state.insert(hand_block(0.01, 0.1), qh, uh);
    terms = make_hand_terms(hand_id, tool_id, spec, hand);
  }

  dynamics::State moved(const VecX& d, const VecX& e, double h) const {
    dynamics::State out = state;
    const dynamics::Block &tool = *out.layout().find(tool_id), &own = *out.layout().find(hand_id);
    auto q = out.q();
    const Vec6 dt = d.segment<6>(tool.u_offset);
    const Quat before(q[tool.q_offset], q[tool.q_offset + 1], q[tool.q_offset + 2], q[tool.q_offset + 3]);
    const Quat r = quaternion_of(h * dt.head<3>()) * before;
    q.segment<4>(tool.q_offset) << r.w(), r.vec();
    q.segment<3>(tool.q_offset + 4) += h * dt.tail<3>();
    q.segment<6>(own.q_offset) += h * d.segment<6>(own.u_offset);
    out.u() += h * e;
    return out;
  }
};

VecX force(dynamics::ForceTerm& term, const dynamics::State& state) {
  VecX f = VecX::Zero(12);
  term.add_force(state.view(), f);
  return f;
}

VecX direction(unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  return VecX::NullaryExpr(12, [&] { return in(rng); });
}

}  // namespace

TEST(HandBlock, tangents_by_taylor) {
  for (unsigned seed = 1; seed < 5; ++seed)
    for (const double size : {1.0, 0.01}) {  // by formula and by series
      Pair pair(seed, size);
      for (const auto& term : {pair.terms.arm, pair.terms.coupling}) {
        const VecX d = direction(seed + 10), e = direction(seed + 20);
        VecX linear = VecX::Zero(12);
        term->apply_tangent(pair.state.view(), 1.0, 0.0, d, linear);
        term->apply_tangent(pair.state.view(), 0.0, 1.0, e, linear);
        const VecX f0 = force(*term, pair.state);
        std::vector<double> hs, errors;
        for (double h = 0.004; h > 1e-4; h /= 2) {
          hs.push_back(h);
          errors.push_back((force(*term, pair.moved(d, e, h)) - f0 + h * linear).norm());
        }
        if (errors.front() < 1e-13 * (f0.norm() + linear.norm())) continue;
        EXPECT_NEAR(slope(hs, errors), 2.0, 0.1) << term->name() << ", " << seed << ", " << size;
      }
    }
}

TEST(HandBlock, assembled_is_applied) {
  Pair pair(3);
  const VecX x = direction(1);
  for (const auto& term : {pair.terms.arm, pair.terms.coupling}) {
    dynamics::BorderedMatrix A;
    A.body = dynamics::PatternBuilder(0).build();
    A.right = MatX::Zero(0, 12);
    A.bottom = MatX::Zero(12, 0);
    A.corner = MatX::Zero(12, 12);
    term->add_tangent(pair.state.view(), 0.7, 0.3, A);
    VecX y = VecX::Zero(12);
    term->apply_tangent(pair.state.view(), 0.7, 0.3, x, y);
    EXPECT_LE((A.corner * x - y).norm(), 1e-13 * y.norm()) << term->name();
    EXPECT_GT(y.norm(), 1.0);
  }
}

// d(stored)/dt = -(power of the forces) - dissipated power, for a path at rest.
TEST(HandBlock, power_is_the_energys_rate_and_what_is_dissipated) {
  for (unsigned seed = 1; seed < 5; ++seed) {
    Pair pair(seed);
    pair.hand.requested = [at = pair.hand.requested(0.0).pose](double) { return HandleState{at, {}}; };
    pair.terms = make_hand_terms(pair.hand_id, pair.tool_id, pair.spec, pair.hand);
    // along the state's motion
    VecX along = pair.state.u();
    const dynamics::Block& own = *pair.state.layout().find(pair.hand_id);
    along.segment<6>(own.u_offset) = pair.state.u().segment<6>(own.u_offset);
    for (const auto& term : {pair.terms.arm, pair.terms.coupling}) {
      const double h = 1e-6;
      const auto energy = [&](double step) {
        return term->energy(pair.moved(along, VecX::Zero(12), step).view());
      };
      const double rate = (energy(h) - energy(-h)) / (2 * h),
                   power = force(*term, pair.state).dot(pair.state.u());
      if (seed == 1) { EXPECT_GT(std::abs(rate), 0.1) << term->name(); }
      // the arm pulls the rotation vector towards the path's: its power is along theta'
      EXPECT_NEAR(power, -rate - term->dissipated_power(pair.state.view()), 1e-6 * (1.0 + std::abs(power)))
          << term->name() << ", " << seed;
    }
  }
}

// The coupling's force on the hand is opposite to that on the tool, and so is its moment.
TEST(HandBlock, coupling_is_opposite_and_equal) {
  Pair pair(2);
  const VecX f = force(*pair.terms.coupling, pair.state);
  const int tool = pair.state.layout().find(pair.tool_id)->u_offset,
            hand = pair.state.layout().find(pair.hand_id)->u_offset;
  EXPECT_LE((f.segment<3>(tool + 3) + f.segment<3>(hand + 3)).norm(), 1e-14 * f.norm());
  const HandleState motion = hand_motion(pair.state.view(), pair.hand_id, pair.hand);
  const VecX u = pair.state.u();
  EXPECT_NEAR(f.segment<3>(hand).dot(u.segment<3>(hand)), -f.segment<3>(tool).dot(motion.twist.angular),
              1e-12 * f.norm());
}

// Coulomb friction and damping oppose the motion; below the regularisation speed friction is reduced: at 1e-5
// m/s by sqrt(2).
TEST(HandBlock, friction_is_coulombs_but_for_the_slowest) {
  Pair pair(4);
  const dynamics::Block& own = *pair.state.layout().find(pair.hand_id);
  dynamics::State state = pair.state;
  const auto on_x = [&](double v) {
    state.u()[own.u_offset + 3] = v;
    return force(*pair.terms.arm, state)[own.u_offset + 3];
  };
  const double c = pair.hand.translation.damping + pair.hand.translation.arm_damping;
  EXPECT_NEAR(on_x(0.01) - on_x(-0.01), -2.0 * (0.7 + c * 0.01), 1e-5);
  EXPECT_NEAR(on_x(1e-5) - on_x(-1e-5), -2.0 * 0.7 / std::sqrt(2.0), 1e-3);
}
