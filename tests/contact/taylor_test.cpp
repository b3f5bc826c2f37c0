// The tangent of every law for every kind of pair, through the whole chain: nodes, skin points or frames,
// gaps, forces on nodes and frames. Points, normals and areas are constant between two queries; changes at a
// query are tested in resultants_test.cpp.
#include <fmt/format.h>

#include <array>

#include "touching.h"

using namespace contact_tests;

namespace {

/// Returns the samples of another source for which `keep` holds.
class KeptSource final : public contact::SampleSource {
 public:
  KeptSource(std::unique_ptr<contact::SampleSource> source,
             std::function<bool(const contact::ContactSample&)> keep)
      : SampleSource({.name = "kept"}), source_(std::move(source)), keep_(std::move(keep)) {}
  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& out) override {
    std::vector<contact::ContactSample> all;
    source_->query(state, all);
    for (const auto& s : all) {
      if (s.gap >= 0.0) continue;
      ++pressed;
      if (!keep_(s)) continue;
      ++kept;
      out.push_back(s);
    }
  }
  void add_pattern(dynamics::PatternBuilder& pattern) const override { source_->add_pattern(pattern); }
  std::uint64_t pattern_version() const override { return source_->pattern_version(); }
  int pressed = 0, kept = 0;

 private:
  std::unique_ptr<contact::SampleSource> source_;
  std::function<bool(const contact::ContactSample&)> keep_;
};

struct Law {
  const char* name;
  const char* spring;
  double friction, onset;
  std::string text() const {
    return fmt::format("{}, {}, friction {}, onset {}", name, spring, friction, onset);
  }
};
/// A spring per point applies to points of a surface; a pixel is no such point.
std::vector<Law> laws(bool of_vertices) {
  std::vector<Law> out;
  for (const char* spring : {"per_area", "per_point"})
    for (const char* name : {"kelvin_voigt", "hunt_crossley"})
      for (const double friction : {0.0, 0.3})
        for (const double onset : {0.0, 0.12})
          if (of_vertices || spring == std::string("per_area"))
            out.push_back({name, spring, friction, onset});
  return out;
}

constexpr double kSlipping = 0.25;  // [m/s]: some points slide faster, some slower
ContactSpec spec_of(const Law& law) {
  ContactSpec out;
  out.law = law.name;
  out.spring = law.spring;
  out.stiffness_pa_m = 1e4;
  out.damping_pa_s_m = 800.0;
  out.stiffness_n_m = 250.0;
  out.damping_n_s_m = 20.0;
  out.hunt_crossley_s_m = 0.4;
  out.friction = law.friction;
  out.friction_regularisation_m_s = kSlipping;
  out.friction_tangent = FrictionTangent::kFull;
  out.onset_width_m = law.onset;
  return out;
}

/// State of a sample with respect to its kinks: open, parting, onset, slipping.
std::array<bool, 4> sides(const contact::ContactSample& s, const Touching& at, const dynamics::State& state,
                          const contact::PressureLaw& law) {
  const auto motion = contact::sample_motion(s, state.view(), frame_states(at, state.view()));
  const Vec3 v_t = motion.a.v - motion.b.v - motion.rate * s.normal;
  return {motion.gap<0.0, contact::pressure(law, motion.gap, motion.rate).p> 0.0, -motion.gap < law.onset,
          v_t.norm() < law.regularisation};
}

VecX direction(Eigen::Index size, unsigned seed) {
  std::mt19937 random(seed);
  VecX out(size);
  for (auto& x : out) x = uniform(random);
  return out;
}

/// (h) - f(0) - h df| over five halvings of h0: slope 2 within the band, or rounding only where f is linear.
template <class Function>
void expect_slope_two(const Function& f, const VecX& df, double h0, bool linear, const std::string& what) {
  const VecX f0 = f(0.0);
  const double scale = f0.norm() + h0 * df.norm();
  ASSERT_GT(h0 * df.norm(), 1e-4 * f0.norm()) << what << ": there is a change to see";
  double before = 0.0;
  for (int i = 0; i <= 5; ++i) {
    const double h = h0 * std::pow(0.5, i), residual = (f(h) - f0 - h * df).norm();
    if (linear) {
      EXPECT_LT(residual, 1e-12 * scale) << what << ", halving " << i;
    } else {
      EXPECT_GT(residual, 1e-12 * scale) << what << ", halving " << i << ": rounding";
      if (i > 0) { EXPECT_NEAR(std::log2(before / residual), 2.0, 0.1) << what << ", halving " << i; }
    }
    before = residual;
  }
}

}  // namespace

// Samples that would cross a kink within the step are removed: the force has no derivative there.
TEST(Taylor, EveryTangentOfEveryPairUnderEveryLaw) {
  int checked = 0, linear_ones = 0, expected = 0;
  for (const TouchingKind& kind : touching_kinds()) {
    expected += 2 * (kind.of_vertices ? 16 : 8);
    for (const Law& law : laws(kind.of_vertices))
      for (const bool by_velocity : {false, true}) {
        const std::string what =
            kind.name + ", " + law.text() + (by_velocity ? ", by velocity" : ", by position");
        const ContactSpec spec = spec_of(law);
        const contact::PressureLaw resolved = contact::pressure_law(spec);
        const double h0 = by_velocity ? 0.02 : 4e-3;
        Touching at = kind.make();
        const VecX d = direction(at.state.layout().u_size, 3);
        const auto step = [&](double h) {
          return by_velocity ? pushed(at.state, d, h) : moved(at.state, d, h);
        };
        const dynamics::State later = step(h0), halfway = step(0.5 * h0);
        const auto away_from_kinks = [&](const contact::ContactSample& s) {
          const auto now = sides(s, at, at.state, resolved);
          return sides(s, at, later, resolved) == now && sides(s, at, halfway, resolved) == now;
        };
        auto source = std::make_unique<KeptSource>(std::move(at.source), away_from_kinks);
        const KeptSource& kept = *source;
        contact::ContactForce term;
        for (const auto& frame : at.frames) term.add_frame(frame);
        term.add_pair(std::move(source), spec);
        term.refresh(at.state.view());
        ASSERT_GT(kept.kept, 10) << what;
        ASSERT_GT(kept.kept, 0.7 * kept.pressed) << what;
        const dynamics::BorderedMatrix A =
            step_matrix(term, at.state, by_velocity ? 0.0 : 1.0, by_velocity ? 1.0 : 0.0);
        VecX Ad;
        A.multiply(d, Ad);
        // Gaps and rates are linear in the nodes' motion, and pressure is linear in either if it sets in at
        // once. Friction is not linear in velocities, nor is a frame's point in its rotation, except on a
        // ball.
        const bool rotates = !at.frames.empty() && at.frames[0]->in_state() && !kind.of_ball;
        const bool linear = by_velocity ? law.friction == 0.0 : law.onset == 0.0 && !rotates;
        expect_slope_two([&](double h) { return force(term, step(h)); }, -Ad, h0, linear, what);
        VecX applied = VecX::Zero(d.size());
        term.apply_tangent(at.state.view(), by_velocity ? 0.0 : 1.0, by_velocity ? 1.0 : 0.0, d, applied);
        EXPECT_LT((applied - Ad).norm(), 1e-12 * Ad.norm()) << what;
        ++checked;
        linear_ones += linear;
      }
  }
  EXPECT_EQ(checked, expected);
  EXPECT_GT(expected, 2 * 8 * static_cast<int>(touching_kinds().size()));
  EXPECT_LT(linear_ones, checked / 2);
}

// For both sides of every pair, forces sum to zero, and so do moments about any point, to rounding; nodes
// carry the pressed point, extrapolated or not. Friction leaves a moment, because its two points are a depth
// apart. A ball by its own points has none about its centre, where the accidental moments of a sum over
// points are assigned to the other side.
TEST(Taylor, ForcesAndMomentsBalance) {
  int checked = 0;
  for (const TouchingKind& kind : touching_kinds())
    for (const double friction : {0.0, 0.3}) {
      Touching at = kind.make();
      contact::ContactForce term;
      for (const auto& frame : at.frames) term.add_frame(frame);
      term.add_pair(std::move(at.source), spec_of({"kelvin_voigt", "per_area", friction, 0.0}));
      term.refresh(at.state.view());
      const auto view = at.state.view();
      const VecX f = force(term, at.state);
      Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
      double size = 0.0, reach = 0.0, deepest = 0.0;
      for (int i = 0; i < at.state.layout().node_count(); ++i) {
        const Vec3 fi = f.segment<3>(3 * i);
        if (fi.isZero(0.0)) continue;
        sum += fi;
        moment += view.position(i).cross(fi);
        size += fi.norm();
        reach = std::max(reach, view.position(i).norm());
      }
      for (std::size_t k = 0; k < at.frames.size(); ++k) {
        const Wrench w = term.frame_wrench(view, static_cast<int>(k));
        sum += w.force;
        moment += w.moment + at.frames[k]->pose(view).translation.cross(w.force);
      }
      for (const auto& s : term.samples()) deepest = std::max(deepest, -s.gap);
      EXPECT_GT(size, 1.0) << kind.name;
      EXPECT_LT(sum.norm(), 1e-12 * size) << kind.name << ", friction " << friction;
      const double by_chance = kind.of_ball ? 0.01 * size * reach : 0.0;
      EXPECT_LT(moment.norm(), 1e-12 * size * reach + friction * deepest * size + by_chance)
          << kind.name << ", friction " << friction;
      ++checked;
    }
  EXPECT_EQ(checked, 2 * static_cast<int>(touching_kinds().size()));
}
