#include <algorithm>

#include "contact/gpu_device.h"
#include "core/counters.h"
#include "images.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

/// A soft unit sphere above a rigid sphere of radius 0.8, in a rotated and moved frame; the line of centres
/// is oblique.
struct Pair {
  Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  double depth = 0.1;
  Pose pose{quaternion_of(Vec3(0.5, 1.1, -0.4)), Vec3(20, -10, 5)};
  TriMesh rigid = sphere(Vec3(0.2, 0.1, -0.1), 0.8, 40);
  Vec3 rigid_centre = pose * Vec3(0.2, 0.1, -0.1);
  SurfaceWorld soft{sphere(rigid_centre + (1.8 - depth) * axis, 1.0, 50)};

  std::vector<contact::ContactSample> samples(int pixels, double candidate_gap) {
    auto source = contact::make_image_source(soft.surface, rigid, 0, contact::fixed_frame(pose),
                                             image_options(pixels, candidate_gap));
    std::vector<contact::ContactSample> out;
    source->query(soft.state.view(), out);
    return out;
  }
};

/// Least or greatest s at which the line x + s n intersects the mesh, in double precision, through all
/// triangles.
double ray(const TriMesh& mesh, const Pose& pose, const Vec3& x, const Vec3& n, bool least) {
  double best = std::nan("");
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Vec3 p0 = pose * mesh.vertices.col(mesh.faces(0, f)),
               p1 = pose * mesh.vertices.col(mesh.faces(1, f)),
               p2 = pose * mesh.vertices.col(mesh.faces(2, f));
    const double d = n.dot((p1 - p0).cross(p2 - p0));
    if (std::abs(d) < 1e-14) continue;
    const Vec3 w =
        Vec3(n.dot((p1 - x).cross(p2 - x)), n.dot((p2 - x).cross(p0 - x)), n.dot((p0 - x).cross(p1 - x))) / d;
    if (w.minCoeff() < 0.0) continue;
    const double s = n.dot(w[0] * p0 + w[1] * p1 + w[2] * p2 - x);
    if (std::isnan(best) || (least ? s < best : s > best)) best = s;
  }
  return best;
}

TriMesh deformed(const SurfaceWorld& world) {
  TriMesh mesh{Points(3, world.surface.node_of_vertex.size()), world.surface.faces};
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
    mesh.vertices.col(i) = world.state.view().position(2 + static_cast<int>(i));
  return mesh;
}

}  // namespace

// The first query opens the OpenGL context, whether or not anything touches: at first touch it would delay
// the loop. Creating a source does not open it.
TEST(ImageSource, OpensAContextInItsFirstQuery) {
  const long before = counters::counter("gl.context").load();
  Pair pair;
  pair.soft.state.q().tail(pair.soft.state.q().size() - 6).array() += 50.0;  // far away
  EXPECT_EQ(counters::counter("gl.context").load(), before);
  EXPECT_TRUE(pair.samples(64, 0.05).empty());
  EXPECT_FALSE(contact::gpu_device().name.empty());
}

// Every gap is compared with a ray through all triangles in double precision; weights and points are
// consistent.
TEST(ImageSource, GapsAreThoseOfTheFacets) {
  Pair pair;
  const auto samples = pair.samples(128, 0.03);
  ASSERT_GT(samples.size(), 100u);
  const TriMesh soft = deformed(pair.soft);
  int pressed = 0, candidates = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& s = samples[i];
    const Vec3 xa = position(s.a, pair.soft.state), xb = pair.pose * s.b.offset;
    EXPECT_NEAR(s.a.weight[0] + s.a.weight[1] + s.a.weight[2], 1.0, 1e-13);
    EXPECT_NEAR(s.normal.dot(xa - xb), s.gap, 1e-13);
    EXPECT_LT((xa - xb).cross(s.normal).norm(), 1e-13);  // both points on one line along the normal
    const double exact =
        ray(soft, Pose{}, xb, s.normal, true) - ray(pair.rigid, pair.pose, xb, s.normal, false);
    worst = std::max(worst, std::abs(s.gap - exact));
    (s.gap < 0 ? pressed : candidates) += 1;
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(pressed, 60);
  EXPECT_GT(candidates, 15);
  EXPECT_GT(samples[0].normal.dot(pair.axis), 0.99);  // from the rigid sphere to the soft one
}

TEST(ImageSource, SamplesDoNotDependOnTheOrderOfTriangles) {
  Pair pair;
  const auto first = pair.samples(96, 0.02);
  EXPECT_GT(first.size(), 100u);
  std::mt19937 random(4);
  for (Faces* faces : {&pair.soft.surface.faces, &pair.rigid.faces}) {
    std::vector<int> order(static_cast<std::size_t>(faces->cols()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::shuffle(order.begin(), order.end(), random);
    *faces = Faces((*faces)(Eigen::all, order));
  }
  const auto second = pair.samples(96, 0.02);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].gap, second[i].gap);
    EXPECT_EQ(first[i].a.node, second[i].a.node);
    EXPECT_EQ(first[i].b.offset, second[i].b.offset);
  }
}

// Force and moment of real samples, oblique and far from the origin: moments about the tool's origin,
// relative to force x body size.
TEST(ImageSource, ForceAndMomentBalance) {
  Pair pair;
  contact::ContactForce term;
  const auto frame = contact::fixed_frame(pair.pose);
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = 1e6;
  term.add_pair(contact::make_image_source(pair.soft.surface, pair.rigid, 0, frame, image_options(128, 0.02)),
                law);
  EXPECT_TRUE(term.refresh(pair.soft.state.view()));
  const VecX f = force(term, pair.soft.state);
  const Wrench w = term.frame_wrench(pair.soft.state.view(), 0);
  Vec3 sum = w.force, moment = w.moment;
  for (int i = 0; i < pair.soft.state.layout().node_count(); ++i) {
    sum += f.segment<3>(3 * i);
    moment += (pair.soft.state.view().position(i) - pair.pose.translation).cross(Vec3(f.segment<3>(3 * i)));
  }
  EXPECT_GT(w.force.norm(), 100.0);
  EXPECT_LT(sum.norm(), 1e-12 * w.force.norm());
  EXPECT_LT(moment.norm(), 1e-12 * w.force.norm());
  auto A = step_matrix(term, pair.soft.state, 1.0, 0.0);  // the announced pattern is the one used
  EXPECT_GT(*std::max_element(A.body.values().begin(), A.body.values().end()), 1.0);
}

// A skin pressed by a ball: each sample is where the image found it. The contact equals the contact of nodes
// at the skin's vertices, and force and moment balance.
TEST(ImageSource, ASkinIsSeenWhereItIs) {
  SkinWorld skin;
  SurfaceWorld nodes({skin.vertices, skin.skin.faces});
  const TriMesh rigid = sphere(Vec3(0, 0, skin.vertices.row(2).maxCoeff() + 0.4), 0.5, 30);
  const auto query = [&](const contact::NodeSurface& surface, const dynamics::State& state) {
    std::vector<contact::ContactSample> out;
    contact::make_image_source(surface, rigid, 0, contact::fixed_frame(), image_options(64, 0.02))
        ->query(state.view(), out);
    return out;
  };
  const auto of_skin = query(skin.surface, skin.state), of_nodes = query(nodes.surface, nodes.state);
  ASSERT_EQ(of_skin.size(), of_nodes.size());
  EXPECT_GT(of_skin.size(), 20u);
  for (const contact::ContactSample& s : of_skin) {  // ordered by the node that carries them
    const auto same = std::min_element(of_nodes.begin(), of_nodes.end(), [&](const auto& p, const auto& q) {
      return (p.b.offset - s.b.offset).norm() < (q.b.offset - s.b.offset).norm();
    });
    EXPECT_LT((same->b.offset - s.b.offset).norm(), 1e-13);
    EXPECT_NEAR(s.gap, same->gap, 1e-13);
    const Vec3 a = point_on_nodes(s.a, skin.state.view());
    EXPECT_LT((a - point_on_nodes(same->a, nodes.state.view())).norm(), 1e-13);
    EXPECT_LT(s.a.offset.norm(), 1e-13) << "a point that its nodes do not carry has a moment of its own";
    EXPECT_NEAR(s.gap, s.normal.dot(a - s.b.offset), 1e-13);
  }
}

// In a flat tetrahedron barycentric coordinates are undefined: the corner's weights and an offset place the
// sample.
TEST(ImageSource, ASkinOnFlatTetrahedraIsSeenWhereItIs) {
  SkinWorld skin;
  // all nodes in the plane z = 0
  for (Eigen::Index i = 8; i < skin.state.q().size(); i += 3) skin.state.q()[i] = 0.0;
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, sphere(Vec3(0, 0, 0.45), 0.5, 30), 0, contact::fixed_frame(),
                             image_options(64, 0.02))
      ->query(skin.state.view(), samples);
  EXPECT_GT(samples.size(), 15u);
  for (const auto& s : samples) {
    EXPECT_TRUE(std::isfinite(s.gap));
    EXPECT_NEAR(s.gap, s.normal.dot(point_on_nodes(s.a, skin.state.view()) - s.b.offset), 1e-12);
  }
}

TEST(ImageSource, RefusesBadOptions) {
  Pair pair;
  const auto message = [&](TriMesh rigid, contact::ImageOptions with) {
    try {
      contact::make_image_source(pair.soft.surface, std::move(rigid), 0, contact::fixed_frame(), with);
    } catch (const std::exception& e) { return std::string(e.what()); }
    return std::string();
  };
  EXPECT_NE(message(pair.rigid, image_options(0, 0.1)).find("pixels = 0 must lie in [16, 4096]"),
            std::string::npos);
  EXPECT_NE(message(pair.rigid, image_options(64, -0.1)).find("candidate gap = -0.1"), std::string::npos);
  EXPECT_NE(message(TriMesh{}, image_options(64, 0.1)).find("two surfaces with faces"), std::string::npos);
  contact::ImageOptions behind = image_options(64, 0.1);
  behind.look_ahead = -1.0;
  EXPECT_NE(message(pair.rigid, behind).find("look-ahead = -1 must not be negative"), std::string::npos);
  contact::ImageOptions shifted = image_options(64, 0.1);
  shifted.shift_v = 1.0;
  EXPECT_NE(message(pair.rigid, shifted).find("grid shift = 1 must lie in [0, 1)"), std::string::npos);
  TriMesh bad = pair.rigid;
  bad.faces(2, 5) = 100000;
  EXPECT_NE(message(bad, image_options(64, 0.1)).find("face 5 has a vertex index out of range"),
            std::string::npos);
}
