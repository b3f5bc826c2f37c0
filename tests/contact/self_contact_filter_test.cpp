// Classification of two overlapping points of one skin: contact, thickness of the body, or parts that passed
// through each other.
#include "contact/self_contact_filter.h"

#include "bent_bar.h"
#include "fixture.h"

using namespace contact_tests;

namespace {

/// The bent bar with its skin.
struct Bar {
  LayeredModel model = bent_bar::model(3);
  dynamics::State state;
  contact::SurfaceState skin;
  contact::SelfContactFilter filter;
  int block_id;

  Bar() : skin(surface()), filter(skin, model.tets.nodes) { bend(0.0); }

  contact::NodeSurface surface() {
    dynamics::BlockSpec nodes;
    nodes.name = "bar";
    nodes.q_size = nodes.u_size = static_cast<int>(model.tets.nodes.size());
    block_id = state.insert(nodes, Eigen::Map<const VecX>(model.tets.nodes.data(), nodes.q_size),
                            VecX::Zero(nodes.u_size));
    contact::NodeSurface out;
    out.block_id = block_id;
    out.faces = model.skin.faces;
    out.embedding = model.embedding;
    out.tets = model.tets.tets;
    return out;
  }
  void bend(double angle) {
    const Points bent = bent_bar::bend(model.tets.nodes, angle);
    state.q() = Eigen::Map<const VecX>(bent.data(), bent.size());
    skin.update(state.view());
  }
  /// The skin point nearest to x at rest, at the centre of its face.
  contact::SkinPoint at(const Vec3& x) const {
    int best = 0;
    double least = 1e9;
    const auto middle = [&](const Points& points, int f) {
      return Vec3((points.col(model.skin.faces(0, f)) + points.col(model.skin.faces(1, f)) +
                   points.col(model.skin.faces(2, f))) /
                  3.0);
    };
    for (int f = 0; f < skin.face_count(); ++f)
      if (const double d = (middle(model.skin.vertices, f) - x).norm(); d < least) best = f, least = d;
    return filter.point(best, Vec3::Constant(1.0 / 3.0), middle(skin.positions(), best));
  }
};

constexpr double kUp = 0.5 * bent_bar::kHeight;

}  // namespace

// However the bar is bent, its tissue lies between its two sides.
TEST(SelfContactFilter, ThicknessIsNoContact) {
  Bar bar;
  int looked = 0;
  for (const double angle : {0.0, 0.7, 2.0, 3.3}) {
    bar.bend(angle);
    for (double x = -0.85; x < 0.86; x += 0.1)
      for (const double shift : {-0.06, 0.0, 0.06}) {
        const contact::SkinPoint above = bar.at(Vec3(x, 0.07, kUp)),
                                 below = bar.at(Vec3(x + shift, -0.02, -kUp));
        EXPECT_FALSE(bar.filter.in_contact(above, below)) << angle << ", " << x << ", " << shift;
        EXPECT_FALSE(bar.filter.in_contact(below, above)) << angle << ", " << x << ", " << shift;
        ++looked;
      }
  }
  EXPECT_EQ(looked, 4 * 18 * 3);
}

// Two arms that overlap by less than their thickness: each inner side lies in the other arm's tissue.
TEST(SelfContactFilter, ArmsThatOverlapAreInContact) {
  Bar bar;
  for (const double depth : {0.015, 0.03, 0.06, 0.1}) {
    bar.bend(bent_bar::closing_angle(depth));
    const contact::SkinPoint left = bar.at(Vec3(-0.885, 0.02, kUp)), right = bar.at(Vec3(0.885, 0.02, kUp));
    ASSERT_GT(left.now.x(), right.now.x() + 1e-3) << "they overlap";
    EXPECT_TRUE(bar.filter.in_contact(left, right)) << depth;
    EXPECT_TRUE(bar.filter.in_contact(right, left)) << depth;
  }
}

// The outer sides of two arms with air between them: the lines from both points leave the tissue.
TEST(SelfContactFilter, WhatPassedByIsNoContact) {
  Bar bar;
  bar.bend(3.3);
  const contact::SkinPoint left = bar.at(Vec3(-0.85, 0, -kUp)), right = bar.at(Vec3(0.85, 0, -kUp));
  ASSERT_GT((right.now - left.now).norm(), 2.0 * bent_bar::kHeight);
  EXPECT_FALSE(bar.filter.in_contact(left, right));
  const contact::SkinPoint inner_left = bar.at(Vec3(-0.85, 0, kUp)), inner_right = bar.at(Vec3(0.85, 0, kUp));
  EXPECT_FALSE(bar.filter.in_contact(left, inner_right)) << "tissue, then air";
  EXPECT_FALSE(bar.filter.in_contact(inner_left, inner_right)) << "air alone";
}

// A node pulled through its tetrahedra: the search line ends at any degenerate or inverted tetrahedron.
TEST(SelfContactFilter, FlatAndInvertedTetrahedraEndTheWay) {
  Bar bar;
  for (const double squash : {0.0, -0.5}) {
    Points nodes = bar.model.tets.nodes;
    nodes.row(2) *= squash;
    bar.state.q() = Eigen::Map<const VecX>(nodes.data(), nodes.size());
    bar.skin.update(bar.state.view());
    EXPECT_FALSE(bar.filter.in_contact(bar.at(Vec3(0.3, 0, kUp)), bar.at(Vec3(0.3, 0, -kUp)))) << squash;
  }
}
