// Contact that occurs before the next query is among the candidates of the last one.
#include "grid_proxies.h"
#include "images.h"
#include "surfaces.h"

using namespace contact_tests;

// A ball rises towards the tool above it and touches it between two queries. With look-ahead, the vertices
// that press at the end were candidates at the start, and press equally hard; without it there were none.
TEST(LookAhead, WhatComesNearerIsKept) {
  constexpr double kApart = 0.05, kSpeed = 6.0, kTime = 0.01;  // the candidate gap is 0.02
  for (const bool pruned : {false, true}) {
    for (const bool looks : {false, true}) {
      SkinWorld skin;
      const double top = skin.vertices.row(2).maxCoeff();
      const TriMesh rigid = sphere(Vec3(0.1, 0.05, top + kApart + 0.5), 0.5, 30);
      for (Eigen::Index i = 2; i < skin.state.u().size(); i += 3) skin.state.u()[i] = kSpeed;
      contact::ImageOptions options = image_options(128, 0.02);
      options.look_ahead = looks ? kTime : 0.0;
      const auto source = [&] {
        return pruned ? contact::make_image_source(
                            skin.surface, proxies_of(skin.ball, skin.skin, skin.surface.embedding, 2), rigid,
                            proxies_of(rigid), 0, contact::fixed_frame(), options)
                      : contact::make_image_source(skin.surface, rigid, 0, contact::fixed_frame(), options);
      };
      std::vector<contact::ContactSample> before, after;
      source()->query(skin.state.view(), before);
      for (Eigen::Index i = 2; i < skin.state.q().size(); i += 3) skin.state.q()[i] += kSpeed * kTime;
      source()->query(skin.state.view(), after);
      double volume_before = 0.0, volume_after = 0.0;  // final overlap by either query's samples
      for (const auto* list : {&before, &after})
        for (const auto& s : *list) {
          const double gap = s.normal.dot(point_on_nodes(s.a, skin.state.view()) - s.b.offset);
          (list == &before ? volume_before : volume_after) += s.area * std::max(0.0, -gap);
        }
      EXPECT_GT(volume_after, 0.0);
      if (looks)
        EXPECT_NEAR(volume_before / volume_after, 1.0, 0.05) << "pruned: " << pruned;
      else
        EXPECT_EQ(volume_before, 0.0) << "pruned: " << pruned;
    }
  }
}

// The tool's centre is at rest; its end swings towards the ball.
TEST(LookAhead, TheEndOfARotatingToolIsLookedAheadFor) {
  SkinWorld skin;
  const Vec3 near(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.55), middle = near + Vec3(2.0, 0, 0);
  TriMesh tool = sphere(near, 0.5, 30);
  const TriMesh far = sphere(near + Vec3(4.0, 0, 0), 0.5, 30);
  const Eigen::Index vertices = tool.vertices.cols(), faces = tool.faces.cols();
  tool.vertices.conservativeResize(3, 2 * vertices);
  tool.vertices.rightCols(vertices) = far.vertices;
  tool.faces.conservativeResize(3, 2 * faces);
  tool.faces.rightCols(faces) = far.faces.array() + static_cast<int>(vertices);
  const auto swinging = std::make_shared<contact::TrajectoryFrame>();
  const Vec3 spin(0, -3.0, 0);  // end speed 6 m/s
  swinging->append(0.0, Pose{}, Twist{spin, -spin.cross(middle)});
  contact::ImageOptions options = image_options(128, 0.02);
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, tool, 0, swinging, options)->query(skin.state.view(), samples);
  EXPECT_TRUE(samples.empty()) << "it is 0.05 apart";
  options.look_ahead = 0.01;
  contact::make_image_source(skin.surface, tool, 0, swinging, options)->query(skin.state.view(), samples);
  EXPECT_GT(samples.size(), 5u);
}
