#include <algorithm>

#include "backends.h"
#include "grid_proxies.h"
#include "palpate/core/counters.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

/// A soft unit sphere above a rigid one of radius 0.8, in a rotated and moved frame; the line of centres is
/// oblique.
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

/// Where the line x + s n meets a surface: least or greatest s.  Double precision, every triangle.
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

ON_EACH_BACKEND(PrunedImageSource);
ON_EACH_BACKEND(ImageSource);

TEST_P(ImageSource, OpensNoContextBeforeItSeesSomething) {
  const long before = counters::counter("gl.context").load();
  Pair pair;
  pair.soft.state.q().tail(pair.soft.state.q().size() - 6).array() += 50.0;  // far away
  EXPECT_TRUE(pair.samples(64, 0.05).empty());
  EXPECT_EQ(counters::counter("gl.context").load(), before);
}

// Every gap against a ray through all the triangles in double; every weight and point consistent.
TEST_P(ImageSource, GapsAreThoseOfTheFacets) {
  Pair pair;
  const auto samples = pair.samples(128, 0.03);
  ASSERT_GT(samples.size(), 3000u);
  const TriMesh soft = deformed(pair.soft);
  int pressed = 0, candidates = 0;
  double worst = 0.0;
  for (std::size_t i = 0; i < samples.size(); i += 29) {
    const auto& s = samples[i];
    const Vec3 xa = position(s.a, pair.soft.state), xb = pair.pose * s.b.offset;
    EXPECT_NEAR(s.a.weight[0] + s.a.weight[1] + s.a.weight[2], 1.0, 1e-13);
    EXPECT_NEAR(s.normal.dot(xa - xb), s.gap, 1e-13);
    EXPECT_LT((xa - xb).cross(s.normal).norm(), 1e-13);  // both on one line along the normal
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

TEST_P(ImageSource, SamplesDoNotDependOnTheOrderOfTriangles) {
  Pair pair;
  const auto first = pair.samples(96, 0.02);
  EXPECT_GT(first.size(), 1000u);
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

// Force and moment of real samples, oblique and far from the origin: about the tool's origin, over force x
// body size.
TEST_P(ImageSource, ForceAndMomentBalance) {
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
  auto A = step_matrix(term, pair.soft.state, 1.0, 0.0);  // the pattern announced is the one that is used
  EXPECT_GT(*std::max_element(A.body.values().begin(), A.body.values().end()), 1.0);
}

// A skin pressed by a ball: each sample lies where the image saw it, so that the contact is that of nodes in
// the skin's places, and force and moment balance.
TEST_P(ImageSource, ASkinIsSeenWhereItIs) {
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
  EXPECT_GT(of_skin.size(), 100u);
  for (std::size_t i = 0; i < of_skin.size(); ++i) {
    EXPECT_NEAR(of_skin[i].gap, of_nodes[i].gap, 1e-13);
    const Vec3 a = point_on_nodes(of_skin[i].a, skin.state.view());
    EXPECT_LT((a - point_on_nodes(of_nodes[i].a, nodes.state.view())).norm(), 1e-13);
    EXPECT_LT(of_skin[i].a.offset.norm(), 1e-13)
        << "a point that its nodes do not carry has a moment of its own";
    EXPECT_NEAR(of_skin[i].gap, of_skin[i].normal.dot(a - of_skin[i].b.offset), 1e-13);
  }
}

// Where the tetrahedron is squashed flat its barycentric coordinates say nothing: the corner's weights and an
// offset place the sample.
TEST_P(ImageSource, ASkinOnFlatTetrahedraIsSeenWhereItIs) {
  SkinWorld skin;
  // all nodes in the plane z = 0
  for (Eigen::Index i = 8; i < skin.state.q().size(); i += 3) skin.state.q()[i] = 0.0;
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, sphere(Vec3(0, 0, 0.45), 0.5, 30), 0, contact::fixed_frame(),
                             image_options(64, 0.02))
      ->query(skin.state.view(), samples);
  EXPECT_GT(samples.size(), 50u);
  for (const auto& s : samples) {
    EXPECT_TRUE(std::isfinite(s.gap));
    EXPECT_NEAR(s.gap, s.normal.dot(point_on_nodes(s.a, skin.state.view()) - s.b.offset), 1e-12);
  }
}

// --- proxies

// One pose, its skin cut into 1, 8 and 64 cells: force and moment within 1 % (each surface point
// contributes once), and the force as large as the uncut surface's, whose plane is the hulls' and tilted by
// some degrees.
TEST_P(PrunedImageSource, ForceDoesNotDependOnTheCut) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.35), 0.5, 30);
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, rigid, 0, contact::fixed_frame(), image_options(256, 0.02))
      ->query(skin.state.view(), samples);
  const Total whole = total(samples, skin.state.view());
  EXPECT_GT(whole.pressed, 1000);
  Total uncut;
  for (const int cells : {1, 2, 4}) {
    samples.clear();
    const auto source = contact::make_image_source(
        skin.surface, proxies_of(skin.ball, skin.skin, skin.surface.embedding, cells), rigid,
        proxies_of(rigid), 0, contact::fixed_frame(), image_options(256, 0.02));
    source->query(skin.state.view(), samples);
    const Total cut = total(samples, skin.state.view());
    if (cells == 1) uncut = cut;
    EXPECT_LT((cut.force - uncut.force).norm(), 0.01 * uncut.force.norm())
        << cells << " cells an edge: " << cut.force.transpose() << " against " << uncut.force.transpose();
    EXPECT_LT((cut.moment - uncut.moment).norm(), 0.01 * uncut.moment.norm())
        << cells << " cells an edge: " << cut.moment.transpose() << " against " << uncut.moment.transpose();
    EXPECT_NEAR(cut.force.norm() / whole.force.norm(), 1.0, 0.01) << cells;
    EXPECT_LT(cut.force.normalized().cross(whole.force.normalized()).norm(), 0.05) << cells;
    ASSERT_NE(source->pruning(), nullptr);
    EXPECT_EQ(source->pruning()->queries, 1);
    EXPECT_LT(source->pruning()->faces_a, skin.skin.faces.cols() / 2);
  }
}

// --- what comes nearer until the next query

// A ball rises towards the tool above it; between two queries it comes to touch.  What a query at the end
// finds pressed was a candidate at the start, and pressed as hard; without looking ahead nothing was.
TEST_P(PrunedImageSource, WhatComesNearerIsKept) {
  constexpr double kApart = 0.05, kSpeed = 6.0, kTime = 0.01;  // a candidate gap is 0.02
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
      double volume_before = 0.0, volume_after = 0.0;  // at the end, of both lists
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

// The middle of the tool stands still, its end swings towards the ball.
TEST_P(ImageSource, TheEndOfARotatingToolIsLookedAheadFor) {
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
  const Vec3 spin(0, -3.0, 0);  // the end at 6 m/s
  swinging->append(0.0, Pose{}, Twist{spin, -spin.cross(middle)});
  contact::ImageOptions options = image_options(128, 0.02);
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, tool, 0, swinging, options)->query(skin.state.view(), samples);
  EXPECT_TRUE(samples.empty()) << "it is 0.05 apart";
  options.look_ahead = 0.01;
  contact::make_image_source(skin.surface, tool, 0, swinging, options)->query(skin.state.view(), samples);
  EXPECT_GT(samples.size(), 50u);
}

// --- resolution by the wanted error

struct Resolved {
  Total total;
  std::size_t samples;
  double estimate;  // of the error, relative
};
Resolved resolved(contact::SampleSource& source, const SkinWorld& skin) {
  std::vector<contact::ContactSample> samples;
  source.query(skin.state.view(), samples);
  return {total(samples, skin.state.view()), samples.size(), source.stages()->quadrature_error};
}

// As few pixels as the wanted error allows, in the whole image and in regions: the force is as near to that
// of very many pixels, and fewer errors cost more samples.
TEST_P(PrunedImageSource, PixelsFollowTheWantedError) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.35), 0.5, 30);
  for (const bool pruned : {false, true}) {
    const auto look = [&](int pixels, double wanted) {
      contact::ImageOptions options = image_options(pixels, 0.02);
      options.quadrature_error = wanted;
      const auto source =
          pruned ? contact::make_image_source(skin.surface,
                                              proxies_of(skin.ball, skin.skin, skin.surface.embedding, 2),
                                              rigid, proxies_of(rigid), 0, contact::fixed_frame(), options)
                 : contact::make_image_source(skin.surface, rigid, 0, contact::fixed_frame(), options);
      return resolved(*source, skin);
    };
    const Resolved all = look(1024, 0.0);
    EXPECT_GT(all.samples, 50000u);
    EXPECT_LT(all.estimate, 2e-6);
    std::size_t before = 0;
    for (const double wanted : {1e-3, 1e-5}) {
      const Resolved some = look(1024, wanted);
      EXPECT_LT(some.estimate, 1.3 * wanted) << "pruned: " << pruned;
      EXPECT_NEAR(some.total.force.norm() / all.total.force.norm(), 1.0, 3.0 * wanted)
          << "pruned: " << pruned << ", " << some.samples << " samples";
      // a region's normal is aligned to a thousandth
      EXPECT_LT(some.total.force.normalized().cross(all.total.force.normalized()).norm(),
                pruned ? 1e-3 : 3.0 * wanted)
          << "pruned: " << pruned << ", " << some.samples << " samples";
      EXPECT_GT(some.samples, before) << "pruned: " << pruned << ", wanted " << wanted;
      before = some.samples;
    }
    EXPECT_LT(look(1024, 1e-3).samples, all.samples / 100) << "pruned: " << pruned;
    EXPECT_LT(before, all.samples / 40) << "no more than a hundred-thousandth needs, pruned: " << pruned;
    // pixels is the most that there may be; the error that is left is told
    const Resolved few = look(24, 1e-4);
    EXPECT_LT(few.samples, 24u * 24u);
    EXPECT_GT(few.estimate, 2e-4) << "pruned: " << pruned;
  }
}

// Two balls of one body with a rigid ball between them: as a whole no height field from any side.  Each is
// pressed away by its own overlap.
TEST_P(PrunedImageSource, FindsContactOnBothSides) {
  TetMesh tets = mesh::ball(1.0, 0.45);
  TriMesh skin = mesh::sphere(1.0, 16);
  const auto twice = [](auto& points, auto& cells) {
    const Eigen::Index n = points.cols(), m = cells.cols();
    points.conservativeResize(3, 2 * n);
    points.rightCols(n) = points.leftCols(n);
    points.row(0).head(n).array() -= 1.3;
    points.row(0).tail(n).array() += 1.3;
    cells.conservativeResize(Eigen::NoChange, 2 * m);
    cells.rightCols(m) = cells.leftCols(m).array() + static_cast<int>(n);
  };
  twice(tets.nodes, tets.tets);
  twice(skin.vertices, skin.faces);
  dynamics::State state;
  dynamics::BlockSpec nodes;
  nodes.name = "balls";
  nodes.q_size = nodes.u_size = static_cast<int>(tets.nodes.size());
  contact::NodeSurface surface;
  surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(tets.nodes.data(), tets.nodes.size()),
                                  VecX::Zero(tets.nodes.size()));
  surface.faces = skin.faces;
  surface.embedding = mesh::embed(tets, skin.vertices);
  surface.tets = tets.tets;
  std::vector<contact::ContactSample> samples;
  const TriMesh rigid = mesh::sphere(0.4, 20);
  const auto source =
      contact::make_image_source(surface, proxies_of(tets, skin, surface.embedding, 4), rigid,
                                 proxies_of(rigid), 0, contact::fixed_frame(), image_options(128, 0.02));
  source->query(state.view(), samples);
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
  for (const auto& s : samples) {
    if (s.gap >= 0.0) continue;
    EXPECT_GT(std::abs(s.normal.x()), 0.9);
    (point_on_nodes(s.a, state.view()).x() < 0.0 ? left : right) -= s.gap * s.area * s.normal;
  }
  // Overlap of spheres of 1 and 0.4 at 1.3: pi (0.1)^2 (d^2 + 2 d (R1 + R2) - 3 (R1 - R2)^2) / (12 d)
  const double d = 1.3, volume = M_PI * 0.01 * (d * d + 2.0 * d * 1.4 - 3.0 * 0.36) / (12.0 * d);
  EXPECT_NEAR(left.x() / -volume, 1.0, 0.05);
  EXPECT_NEAR(right.x() / volume, 1.0, 0.05);
  EXPECT_LT((left + right).norm(), 0.01 * volume)
      << left.transpose() << " and " << right.transpose() << " of " << volume;
  EXPECT_GE(source->pruning()->regions, 2);
}

TEST_P(PrunedImageSource, RefusesWhatDoesNotBelongTogether) {
  SkinWorld skin;
  SurfaceWorld nodes({skin.vertices, skin.skin.faces});
  const auto proxies = proxies_of(skin.ball, skin.skin, skin.surface.embedding, 1);
  const TriMesh rigid = sphere(Vec3::Zero(), 0.5, 8);
  const auto of_rigid = proxies_of(rigid);
  EXPECT_THROW(contact::make_image_source(nodes.surface, proxies, rigid, of_rigid, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError)
      << "nodes have no embedding to follow";
  EXPECT_THROW(contact::make_image_source(skin.surface, proxies, rigid, nullptr, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError);
  EXPECT_THROW(contact::make_image_source(skin.surface, proxies, sphere(Vec3::Zero(), 0.5, 9), of_rigid, 0,
                                          contact::fixed_frame(), image_options(64, 0.02)),
               InternalError);
  contact::NodeSurface fewer = skin.surface;
  fewer.faces.conservativeResize(3, fewer.faces.cols() - 1);
  EXPECT_THROW(contact::make_image_source(fewer, proxies, rigid, of_rigid, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError);
}

// A second query sees the body where it is then, not where it was.
TEST_P(PrunedImageSource, FollowsTheBody) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.0, -1.6), 0.8, 20);
  const auto source_of = [&] {
    return contact::make_image_source(skin.surface,
                                      proxies_of(skin.ball, skin.skin, skin.surface.embedding, 2), rigid,
                                      proxies_of(rigid), 0, contact::fixed_frame(), image_options(96, 0.02));
  };
  const auto kept = source_of();
  std::vector<contact::ContactSample> before, after, expected;
  kept->query(skin.state.view(), before);
  auto q = skin.state.q();
  for (Eigen::Index i = 0; i + 2 < q.size(); i += 3) {  // stretched and shifted
    q[i] = 1.1 * q[i] + 0.02;
    q[i + 2] *= 0.97;
  }
  kept->query(skin.state.view(), after);
  source_of()->query(skin.state.view(), expected);
  ASSERT_GT(expected.size(), 500u);
  ASSERT_EQ(after.size(), expected.size());
  for (std::size_t i = 0; i < after.size(); i += 17)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(after[i].a.weight[k], expected[i].a.weight[k], 1e-12);
}

TEST_P(ImageSource, RefusesBadOptions) {
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
  contact::ImageOptions exact = image_options(64, 0.1);
  exact.quadrature_error = 0.5;
  EXPECT_NE(message(pair.rigid, exact).find("quadrature error = 0.5 must lie in [0, 0.1]"),
            std::string::npos);
  contact::ImageOptions behind = image_options(64, 0.1);
  behind.look_ahead = -1.0;
  EXPECT_NE(message(pair.rigid, behind).find("look-ahead = -1 must not be negative"), std::string::npos);
  contact::ImageOptions shifted = image_options(64, 0.1);
  shifted.shift_v = 1.0;
  EXPECT_NE(message(pair.rigid, shifted).find("grid shift = 1 must lie in [0, 1)"), std::string::npos);
  TriMesh bad = pair.rigid;
  bad.faces(2, 5) = 100000;
  EXPECT_NE(message(bad, image_options(64, 0.1)).find("face 5 names a vertex"), std::string::npos);
}
