#include "contact/region_piece.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "palpate/dynamics/state.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

namespace {

/// Where a face of a patch points, along the normal of its axes.
double area_along(const contact::Patch& patch, const Faces& faces, Eigen::Index f) {
  const auto p = [&](int k) { return Vec3(patch.uvw.col(faces(k, f))); };
  return (p(1) - p(0)).cross(p(2) - p(0)).z();
}

}  // namespace

// of a box seen from below: what a region holds is seen where it faces down; what its body has elsewhere is
// never seen, and where it faces up the body is left
TEST(RegionPiece, OtherFacesOfItsBodyAreWhereItIsLeft) {
  const TriMesh box = mesh::box_surface(Vec3(1, 1, 1), {2, 2, 2});
  const auto side = contact::rigid_side(box, 0, contact::fixed_frame());
  const dynamics::State state;
  side->update(state.view());
  std::vector<int> own, others, local;
  const contact::ContactAxes axes(Vec3::Zero(), Vec3::UnitZ());
  for (Eigen::Index f = 0; f < box.faces.cols(); ++f) {
    const bool left_half = box.vertices.col(box.faces(0, f)).x() + box.vertices.col(box.faces(1, f)).x() +
                               box.vertices.col(box.faces(2, f)).x() <
                           0.0;
    (left_half ? own : others).push_back(static_cast<int>(f));
  }
  contact::RegionPiece piece;
  contact::Patch patch;
  piece.take(*side, own, local, others);
  piece.see(axes, -1.0, patch);
  EXPECT_EQ(patch.faces->cols(), 4);  // half of the bottom's eight
  for (Eigen::Index f = 0; f < patch.faces->cols(); ++f) {
    EXPECT_LT(area_along(patch, *patch.faces, f), 0.0);
    EXPECT_TRUE(std::count(own.begin(), own.end(), piece.face_of(static_cast<int>(f))));
  }
  ASSERT_TRUE(patch.away);
  long up = 0;
  for (Eigen::Index f = 0; f < patch.away->cols(); ++f) up += area_along(patch, *patch.away, f) > 0.0;
  EXPECT_EQ(up, 8);  // the top, of both
  piece.take(*side, own, local);
  piece.see(axes, -1.0, patch);
  up = 0;
  for (Eigen::Index f = 0; f < patch.away->cols(); ++f) up += area_along(patch, *patch.away, f) > 0.0;
  EXPECT_EQ(up, 4);
}
