// Self-contact of a skin, against a search through all of its faces.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "distance/skin_contact.h"
#include "palpate/mesh/generators.h"

using namespace palpate;
using namespace palpate::distance;

namespace {

/// A bar along x, bent about y by an angle over its middle third; its ends remain straight.
Points bent(const Points& straight, double length, double angle) {
  Points out = straight;
  if (angle == 0.0) return out;
  const double third = length / 3.0, r = third / angle;
  for (auto x : out.colwise()) {
    const double along = std::clamp(x[0], -0.5 * third, 0.5 * third), beyond = x[0] - along, phi = along / r;
    const Vec3 tangent(std::cos(phi), 0.0, std::sin(phi)), inwards(-std::sin(phi), 0.0, std::cos(phi));
    x = Vec3(r * std::sin(phi), x[1], r * (1.0 - std::cos(phi))) + beyond * tangent + x[2] * inwards;
  }
  return out;
}

/// Two sheets that lie on each other, each with two layers of faces 2 mm apart: bisection puts both in one
/// cluster.
TriMesh two_sheets() {
  const TriMesh sheet = mesh::box_surface(Vec3(1.0, 1.0, 0.002), {12, 12, 1});
  TriMesh out;
  const int count = static_cast<int>(sheet.vertices.cols());
  out.vertices.resize(3, 2 * count);
  out.vertices << sheet.vertices, sheet.vertices.colwise() + Vec3(0.0, 0.0, 0.004);
  out.faces.resize(3, 2 * sheet.faces.cols());
  out.faces << sheet.faces, (sheet.faces.array() + count).matrix();
  return out;
}

struct Own {
  TriMesh rest;
  Skin skin;
  double radius;
  SkinContact contact;

  Own(const TriMesh& mesh, double neighbourhood)
      : rest(mesh),
        skin(make_skin(mesh, Clusters::kConnected)),
        radius(neighbourhood),
        contact(skin, 1.0, contact_mesh(skin, HUGE_VAL), own()) {}
  OwnContact own() const {
    return {OwnNeighbourhood(skin, rest.vertices, radius),
            [](const ContactPoint&, const Vec3&, const Foot&) { return true; }};
  }
  void find(const Points& x, double near) { contact.find(x.data(), x.data(), near); }

  /// Contact points found by a search through all faces, with their gaps.
  std::map<int, double> by_all_faces(const Points& x, double near) const {
    const OwnContact own = this->own();
    Surface surface(skin);
    surface.move(x.data());
    std::map<int, double> out;
    for (std::size_t p = 0; p < contact.points(0).size(); ++p) {
      const ContactPoint& point = contact.points(0)[p];
      const Vec3 at = surface.point(point.face, point.weights);
      Foot best, of_all;
      best.at.distance2 = of_all.at.distance2 = HUGE_VAL;
      for (int f = 0; f < skin.face_count(); ++f) {
        const TrianglePoint here = surface.nearest_on_face(f, at);
        if (own.neighbours.may_touch(point.face / kClusterFaces, f / kClusterFaces) &&
            here.distance2 < best.at.distance2)
          best = {f, here};
      }
      if (best.face < 0) continue;
      // nearer on a neighbour that shares the foot: the skin is continuous there
      if (!own.neighbours.may_touch(point.face / kClusterFaces,
                                    surface.nearest_around(at, best.face).face / kClusterFaces))
        continue;
      const double distance = std::sqrt(best.at.distance2);
      const bool is_inside = surface.is_inside(best);
      if (is_inside ? distance < own.depth() : distance < near)
        out[static_cast<int>(p)] = is_inside ? -distance : distance;
    }
    return out;
  }
};

std::map<int, double> near_ones(const SkinContact& contact, double near) {
  std::map<int, double> out;
  for (const Spring& s : contact.springs())
    if (s.is_placed && s.gap < near) out[s.point] = s.gap;
  return out;
}

void expect_equal(const std::map<int, double>& found, const std::map<int, double>& requested,
                  const std::string& what) {
  for (const auto& [point, gap] : requested) {
    ASSERT_TRUE(found.contains(point)) << what << ": point " << point << ", gap " << gap;
    // the search may take either face if their distances agree to single precision
    EXPECT_NEAR(found.at(point), gap, 1e-7) << what << ": point " << point;
  }
  for (const auto& [point, gap] : found)
    EXPECT_TRUE(requested.contains(point) || gap > 0.0) << what << ": point " << point << ", gap " << gap;
}

}  // namespace

// Moving from pose to pose, with clusters known to be clear and without, the search finds the same springs as
// a search through all faces.
TEST(OwnSkinContact, FindsWhatASearchThroughAllFacesFinds) {
  const double length = 2.0;
  const TriMesh bar = mesh::box_surface(Vec3(length, 0.3, 0.2), {60, 9, 6});
  Own through(bar, 0.12);
  std::mt19937 random(3);
  std::normal_distribution<double> some(0.0, 0.002);
  int overlaps = 0;
  for (const double angle : {0.0, 4.2, 4.3, 4.6, 3.0, 4.5}) {
    Points x = bent(bar.vertices, length, angle);
    for (auto& c : x.reshaped()) c += some(random);
    for (const double near : {0.0, 0.02}) {
      const auto what = std::to_string(angle) + " " + std::to_string(near);
      through.find(x, near);
      Own anew(bar, 0.12);
      anew.find(x, near);
      const auto requested = anew.by_all_faces(x, near);
      expect_equal(near_ones(anew.contact, near), requested, "anew, " + what);
      ASSERT_EQ(through.contact.springs().size(), anew.contact.springs().size()) << what;
      for (std::size_t i = 0; i < anew.contact.springs().size(); ++i) {
        EXPECT_EQ(through.contact.springs()[i].gap, anew.contact.springs()[i].gap) << what;
        EXPECT_EQ(through.contact.springs()[i].force, anew.contact.springs()[i].force) << what;
      }
      for (const auto& [point, gap] : requested) overlaps += gap < 0.0;
    }
  }
  EXPECT_GT(overlaps, 500);
}

// Sheets that lie on each other share no cluster, and collide where they are pressed together.
TEST(OwnSkinContact, SheetsOnEachOtherHaveClustersOfTheirOwn) {
  const TriMesh sheets = two_sheets();
  Own own(sheets, 0.1);
  const auto half = static_cast<int>(sheets.vertices.cols() / 2);
  std::set<int> given;
  for (int c = 0; c < own.skin.cluster_count(); ++c) {
    std::set<bool> is_upper;
    for (int f = kClusterFaces * c; f < std::min(kClusterFaces * (c + 1), own.skin.face_count()); ++f) {
      given.insert(own.skin.given_face[static_cast<std::size_t>(f)]);
      is_upper.insert(own.skin.faces(0, f) >= half);
    }
    EXPECT_EQ(is_upper.size(), 1u) << c;
  }
  EXPECT_EQ(given.size(), static_cast<std::size_t>(sheets.faces.cols()));
  EXPECT_GT(own.skin.face_count(), sheets.faces.cols()) << "nothing was filled up: too coarse a test";
  EXPECT_NEAR(own.skin.area.sum(), 2.0 * (2.0 + 4.0 * 0.002), 1e-12);
  double area = 0.0;
  for (const ContactTriangle& t : contact_mesh(own.skin, 0.05).triangles) area += t.area;
  EXPECT_NEAR(area, own.skin.area.sum(), 1e-12);

  Points x = sheets.vertices;
  x.rightCols(half).row(2).array() -= 0.0025;  // overlapping by half a millimetre
  own.find(x, 0.0);
  int lower = 0, upper = 0;
  for (const Spring& s : own.contact.springs()) {
    if (s.force == 0.0) continue;
    const int of = own.skin.faces(0, own.contact.points(0)[static_cast<std::size_t>(s.point)].face);
    ++(of < half ? lower : upper);
  }
  EXPECT_GT(lower, 100);
  EXPECT_GT(upper, 100);

  // apart, but within the search distance
  x = sheets.vertices;
  x.rightCols(half).row(2).array() += 0.01;
  own.find(x, 0.02);
  EXPECT_GT(near_ones(own.contact, 0.0125).size(), 300u);
  own.find(x, 0.0);
  EXPECT_TRUE(near_ones(own.contact, 1.0).empty());
}

// Clusters known to be clear are left out of the search without effect on the result: limbs separate,
// starting deeper than overlaps are detected, in steps shorter than the clearance.
TEST(OwnSkinContact, FindsTheSameWhateverWasBefore) {
  const double length = 2.0;
  const TriMesh bar = mesh::box_surface(Vec3(length, 0.3, 0.2), {120, 18, 12});
  Own through(bar, 0.04);
  int deepest = 0, pressing = 0;
  for (double angle = 5.2; angle > 4.0; angle -= 0.02) {
    const Points x = bent(bar.vertices, length, angle);
    through.find(x, 0.005);
    Own anew(bar, 0.04);
    anew.find(x, 0.005);
    ASSERT_EQ(through.contact.springs().size(), anew.contact.springs().size()) << angle;
    for (std::size_t i = 0; i < anew.contact.springs().size(); ++i) {
      EXPECT_EQ(through.contact.springs()[i].point, anew.contact.springs()[i].point) << angle;
      EXPECT_EQ(through.contact.springs()[i].gap, anew.contact.springs()[i].gap) << angle;
      EXPECT_EQ(through.contact.springs()[i].force, anew.contact.springs()[i].force) << angle;
      pressing += anew.contact.springs()[i].force > 0.0;
    }
    deepest += anew.contact.deepest() > 0.018;
  }
  EXPECT_GT(pressing, 1000);
  EXPECT_GT(deepest, 5) << "overlaps reach the depth of 0.02 up to which they are found";
}

// Neighbourhoods of a bar bent to a U: opposite sides of one arm have tissue in between, and the two arms
// have air. Clusters adjacent along the skin are neighbours in any case.
TEST(OwnSkinContact, NeighboursAreNearAlongTheSkinOrThroughTissue) {
  const double length = 2.0, radius = 0.25;
  const TriMesh bar = mesh::box_surface(Vec3(length, 0.8, 0.2), {60, 24, 6});
  const Points rest = bent(bar.vertices, length, M_PI);  // arms 0.22 apart
  const Skin skin = make_skin({rest, bar.faces}, Clusters::kConnected);
  const OwnNeighbourhood neighbours(skin, rest, radius);
  struct Place {
    Vec3 middle = Vec3::Zero();             // centre on the straight bar
    bool is_inner = true, is_outer = true;  // all vertices on that side
  };
  std::vector<Place> places;
  for (int c = 0; c < skin.cluster_count(); ++c) {
    Place& place = places.emplace_back();
    const int begin = skin.cluster_begin[static_cast<std::size_t>(c)],
              end = skin.cluster_begin[static_cast<std::size_t>(c) + 1];
    for (int i = begin; i < end; ++i) {
      const Vec3 x = bar.vertices.col(skin.cluster_vertices[static_cast<std::size_t>(i)]);
      place.middle += x / (end - begin);
      place.is_inner = place.is_inner && x[2] > 0.0999;
      place.is_outer = place.is_outer && x[2] < -0.0999;
    }
  }
  int along = 0, tissue = 0, air = 0;
  for (int c = 0; c < skin.cluster_count(); ++c)
    for (int d = 0; d < skin.cluster_count(); ++d) {
      EXPECT_EQ(neighbours.may_touch(c, d), neighbours.may_touch(d, c)) << c << ", " << d;
      const Place &a = places[static_cast<std::size_t>(c)], &b = places[static_cast<std::size_t>(d)];
      const double apart = (a.middle - b.middle).norm(), across = (a.middle - b.middle).tail<2>().norm();
      const bool of_one_arm = a.middle[0] * b.middle[0] > 0.0 && std::abs(a.middle[0]) > 0.4;
      if (a.is_inner && b.is_inner && apart < 0.2) {
        EXPECT_FALSE(neighbours.may_touch(c, d)) << c << ", " << d;
        ++along;
      }
      if (a.is_inner && b.is_outer && of_one_arm && apart < 0.22) {
        EXPECT_FALSE(neighbours.may_touch(c, d)) << c << ", " << d;
        ++tissue;
      }
      if (a.is_inner && b.is_inner && a.middle[0] < -0.6 && b.middle[0] > 0.6 && across < 0.1) {
        EXPECT_TRUE(neighbours.may_touch(c, d)) << c << ", " << d;
        ++air;
      }
    }
  EXPECT_GT(along, 50);
  EXPECT_GT(tissue, 5);
  EXPECT_GT(air, 5);
}
