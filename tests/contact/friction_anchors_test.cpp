// Friction springs between material points that move, rotate, roll and separate.
#include "contact/friction_anchors.h"

#include <gtest/gtest.h>

#include "palpate/dynamics/state.h"

using namespace palpate;
using namespace palpate::contact;

namespace {

constexpr double kTau = 0.01, kSpeed = 1e-3, kLongest = kTau * kSpeed;  // [s], [m/s], [m]

/// Two frames that touch at the origin, with the normal along z, and a triangle of nodes there.
struct Anchored {
  std::vector<FrameState> frames{2};
  dynamics::State state;
  std::vector<ContactSample> samples{1};
  std::vector<int> points{7};
  FrictionAnchors anchors{kTau, kSpeed};

  Anchored() {
    samples[0].a.frame = 0;
    samples[0].b.frame = 1;
    samples[0].gap = -1e-3;
    samples[0].area = 1.0;
    dynamics::BlockSpec nodes;
    nodes.name = "nodes";
    nodes.q_size = nodes.u_size = 9;
    VecX q(9);
    q << 0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0;
    state.insert(nodes, q, VecX::Zero(9));
  }
  void place(std::size_t frame, const Pose& pose) {
    frames[frame].pose = pose;
    frames[frame].R = pose.rotation.toRotationMatrix();
  }
  /// Places the second point as a query does: at the first point, apart from the offset along the normal.
  void meet(SurfacePoint& b) const {
    const Vec3 x = frames[0].pose.translation;
    if (b.frame >= 0) {
      b.offset = frames[1].R.transpose() * (x - frames[1].pose.translation - b.slide);
      return;
    }
    b.offset = x;
    for (std::size_t k = 0; k < 3; ++k) b.offset -= b.weight[k] * state.view().position(b.node[k]);
  }
  Vec3 renewed() {
    for (ContactSample& s : samples) meet(s.b);
    anchors.renew(samples, points, state.view(), frames);
    return kTau * samples[0].deflection_rate;
  }
  Vec3 followed() {
    anchors.follow(samples, state.view(), frames);
    return kTau * samples[0].deflection_rate;
  }
};

}  // namespace

// A query moves the anchors and changes no deflection; a sliding spring is limited to its maximum length.
TEST(FrictionAnchors, AreTheWayOfTheMaterialWithinTheCone) {
  Anchored touch;
  EXPECT_EQ(touch.renewed(), Vec3(0, 0, 0));
  const Vec3 way(3e-6, 4e-6, 0);
  touch.place(0, {Quat::Identity(), way + Vec3(0, 0, -1e-4)});  // the normal part does not count
  EXPECT_LT((touch.followed() - way).norm(), 1e-18);
  EXPECT_LT((touch.renewed() - way).norm(), 1e-18);
  EXPECT_LT((touch.followed() - way).norm(), 1e-18);
  touch.place(0, {Quat::Identity(), Vec3(1e-3, 0, 0)});
  EXPECT_NEAR(touch.followed().norm(), kLongest, 1e-18);
  EXPECT_GT(touch.followed().x(), 0.99 * kLongest);
  // return by the length of the spring: the anchor had moved along
  touch.renewed();
  touch.place(0, {Quat::Identity(), Vec3(1e-3 - kLongest, 0, 0)});
  EXPECT_LT(touch.followed().norm(), 0.02 * kLongest);
}

// Deflections rotate with the body that carries the second point (frame or nodes), so that two bodies that
// rotate together keep them.
TEST(FrictionAnchors, RotateWithWhatTouches) {
  const Vec3 way(5e-6, 0, 0);
  const Quat turn(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()));
  for (const bool on_nodes : {false, true}) {
    Anchored touch;
    if (on_nodes) {
      SurfacePoint& b = touch.samples[0].b;
      b = {};
      b.count = 3;
      b.node = {0, 1, 2, 0};
      b.weight = {0.4, 0.3, 0.3, 0.0};
    }
    touch.renewed();
    touch.place(0, {Quat::Identity(), way});
    EXPECT_LT((touch.followed() - way).norm(), 1e-16) << on_nodes;
    for (const bool is_renewed : {false, true}) {
      if (is_renewed) touch.renewed();
      Anchored turned = touch;
      turned.place(0, {turn, turn * way});
      turned.place(1, {turn, Vec3::Zero()});
      for (int i = 0; i < 3; ++i)
        turned.state.q().segment<3>(3 * i) = turn * Vec3(touch.state.q().segment<3>(3 * i));
      EXPECT_LT((turned.followed() - turn * way).norm(), 1e-16) << on_nodes << ", " << is_renewed;
    }
  }
}

// A round surface whose point is given by its centre and a slide along the normal: rolling is no sliding,
// spinning in place is.
TEST(FrictionAnchors, RollingIsNoSliding) {
  constexpr double kRadius = 0.05, kAngle = 1e-4;
  Anchored touch;
  SurfacePoint& b = touch.samples[0].b;
  b.slide = Vec3(0, 0, -kRadius);
  touch.place(1, {Quat::Identity(), Vec3(0, 0, kRadius)});
  touch.renewed();
  const Quat turn(Eigen::AngleAxisd(kAngle, Vec3::UnitY()));
  touch.place(1, {turn, Vec3(kRadius * kAngle, 0, kRadius)});
  EXPECT_LT(touch.followed().norm(), kRadius * kAngle * kAngle);
  touch.place(1, {turn, Vec3(0, 0, kRadius)});
  EXPECT_NEAR(touch.followed().x(), kRadius * kAngle, kRadius * kAngle * kAngle);
}

// Springs of points that separate or disappear are reset; all others are kept.
TEST(FrictionAnchors, EndWhereItsPointsPart) {
  Anchored touch;
  touch.samples.assign(3, touch.samples[0]);
  touch.points = {2, 5, 9};
  touch.renewed();
  const Vec3 way(5e-6, 0, 0);
  touch.place(0, {Quat::Identity(), way});
  touch.renewed();
  touch.samples[1].gap = 1e-6;
  touch.renewed();
  EXPECT_LT((kTau * touch.samples[0].deflection_rate - way).norm(), 1e-18);
  EXPECT_EQ(touch.samples[1].deflection_rate, Vec3(0, 0, 0));
  touch.samples[1].gap = -1e-6;
  touch.points = {2, 5, 7};  // 9 is gone, 7 is new
  touch.renewed();
  EXPECT_LT((kTau * touch.samples[0].deflection_rate - way).norm(), 1e-18);
  EXPECT_EQ(touch.samples[1].deflection_rate, Vec3(0, 0, 0));
  EXPECT_EQ(touch.samples[2].deflection_rate, Vec3(0, 0, 0));
  touch.points.clear();  // without material points
  touch.renewed();
  touch.samples[0].deflection_rate.setZero();
  EXPECT_EQ(touch.followed(), Vec3(0, 0, 0));
}

TEST(FrictionAnchors, AreKeptAndGivenBackToTheLastBit) {
  Anchored touch;
  touch.renewed();
  touch.place(0, {Quat(Eigen::AngleAxisd(0.1, Vec3(1, 2, 3).normalized())), Vec3(3e-6, 1e-6, 0)});
  const Vec3 kept = touch.renewed();
  EXPECT_GT(kept.norm(), 1e-6);
  Archive out;
  touch.anchors.archive(out);
  Anchored again = touch;
  again.anchors = FrictionAnchors(kTau, kSpeed);
  EXPECT_EQ(Anchored(again).renewed(), Vec3(0, 0, 0)) << "without the archive";
  Archive in(out.values(), "test");
  again.anchors.archive(in);
  EXPECT_EQ(again.renewed(), kept);
  EXPECT_EQ(again.followed(), touch.followed());
}
