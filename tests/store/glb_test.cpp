#include "store/glb.h"

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/python_check.h"
#include "store/sample_run.h"

namespace {

using namespace palpate;

/// A tetrahedron that is stretched along z by another amount at each time.
store::MovingSurface body(int times) {
  store::MovingSurface out;
  out.name = "body";
  out.faces.resize(3, 4);
  out.faces << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  for (int k = 0; k < times; ++k) {
    Points p(3, 4);
    p << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1.0 + 0.5 * k * k;
    out.points.push_back(p);
  }
  return out;
}

/// A triangle that rotates about z by 1.75 rad per time step, and rises.
store::MovingSurface tool(int times) {
  store::MovingSurface out;
  out.name = "tool";
  out.opacity = 0.5;
  out.faces.resize(3, 1);
  out.faces << 0, 1, 2;
  Points p(3, 3);
  p << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  out.points = {p};
  for (int k = 0; k < times; ++k)
    out.poses.push_back({quaternion_of(Vec3(0, 0, k * 1.75)), Vec3(0.5, 0, 0.25 * k)});
  return out;
}

class Glb : public python_check::Test {
 protected:
  nlohmann::json seen(const std::vector<store::MovingSurface>& surfaces, const std::vector<double>& times) {
    store::write_atomically(folder_ / "one.glb", store::glb_of(surfaces, times, "a run", "palpate test"));
    return python_check::foreign("glb", folder_ / "one.glb");
  }
  sample_run::Folder folder_;
};

void expect_shown(const nlohmann::json& shown, const std::vector<Points>& expected) {
  ASSERT_EQ(shown.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    for (Eigen::Index i = 0; i < expected[k].cols(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(shown[k][static_cast<std::size_t>(i)][static_cast<std::size_t>(axis)].get<double>(),
                    expected[k](axis, i), 1e-6)
            << "time " << k << ", point " << i;
}

TEST_F(Glb, ShowsEachInstantZUp) {
  const nlohmann::json file = seen({body(4), tool(4)}, {0.5, 0.6, 0.8, 1.5});
  const std::vector<double> times = {0.0, 0.1, 0.3, 1.0};
  ASSERT_EQ(file["times"].size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(file["times"][k].get<double>(), times[k], 1e-7);
  expect_shown(file["shown"]["body"], body(4).points);
  std::vector<Points> turned;
  for (const Pose& pose : tool(4).poses)
    turned.push_back((pose.rotation.toRotationMatrix() * tool(1).points[0]).colwise() + pose.translation);
  expect_shown(file["shown"]["tool"], turned);
  EXPECT_EQ(file["faces"]["tool"], nlohmann::json::parse("[[0, 1, 2]]"));
  EXPECT_EQ(file["faces"]["body"].size(), 4u);
  EXPECT_EQ(file["asset"]["generator"], "palpate test");
}

TEST_F(Glb, OneInstantStandsStill) {
  const nlohmann::json file = seen({body(1), tool(1)}, {0.5});
  EXPECT_TRUE(file["times"].empty());
  expect_shown(file["shown"]["body"], body(1).points);
  expect_shown(file["shown"]["tool"], {tool(1).points[0].colwise() + Vec3(0.5, 0, 0)});
}

TEST_F(Glb, NamesMayHoldQuotes) {
  store::MovingSurface odd = body(2);
  odd.name = "a \"b\" \\ c";
  EXPECT_TRUE(seen({odd}, {0.0, 1.0})["shown"].contains(odd.name));
}

/// glTF requires it: otherwise a viewer rotates the long way round between two keyframes.
TEST_F(Glb, NeighbouringRotationsHaveTheSameSign) {
  store::MovingSurface flipped = tool(3);
  flipped.poses[1].rotation.coeffs() *= -1.0;
  const std::string plain = store::glb_of({tool(3)}, {0, 1, 2}, "", ""),
                    other = store::glb_of({flipped}, {0, 1, 2}, "", "");
  EXPECT_EQ(plain, other);
}

TEST_F(Glb, RefusesWhatDoesNotFitTogether) {
  EXPECT_THROW(store::glb_of({body(2)}, {0.0}, "", ""), InternalError);
  EXPECT_THROW(store::glb_of({body(2)}, {1.0, 1.0}, "", ""), InternalError);
  EXPECT_THROW(store::glb_of({tool(2)}, {0.0, 1.0, 2.0}, "", ""), InternalError);
  store::MovingSurface bad = body(1);
  bad.faces(0, 0) = 4;
  EXPECT_THROW(store::glb_of({bad}, {0.0}, "", ""), InternalError);
}

}  // namespace
