#include "store/surface_files.h"

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/part_surface.h"
#include "store/python_check.h"
#include "store/sample_run.h"

namespace {

using namespace palpate;
using Rows = std::vector<std::vector<int>>;

/// A square of two triangles, and a triangle with numbers that single precision cannot represent.
std::vector<store::SurfaceState> surfaces() {
  store::SurfaceState square{"soft ball", Points(3, 4), Faces(3, 2), VecX(4), VecX(4), {}};
  square.points << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0.5;
  square.faces << 0, 0, 1, 2, 2, 3;
  square.displacement << 0.0, 0.25, 0.5, 0.75;
  square.stress << 1.0, 2.0, 3.0, 4.0;
  square.colours = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {1, 2, 3}};
  store::SurfaceState tool{"tool", Points(3, 3), Faces(3, 1), VecX::Zero(3), VecX::Zero(3), {}};
  tool.points << 0.1, 1, 0, 0, 1. / 3., 1, 2, 2, -1e-7;
  tool.faces << 0, 1, 2;
  tool.colours.assign(3, {9, 9, 9});
  return {square, tool};
}

class SurfaceFiles : public python_check::Test {
 protected:
  nlohmann::json seen(const std::string& kind, const std::string& content) {
    store::write_atomically(folder_ / "one", content);
    return python_check::foreign(kind, folder_ / "one");
  }
  sample_run::Folder folder_;
};

TEST_F(SurfaceFiles, ObjReadsBackExactly) {
  const nlohmann::json file = seen("obj", store::obj_of(surfaces(), "two\nlines"));
  ASSERT_EQ(file.size(), 2u);
  EXPECT_EQ(file[0]["name"], "soft_ball");
  EXPECT_EQ(file[1]["name"], "tool");
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(file[i]["points"], python_check::rows_of(surfaces()[i].points));
  EXPECT_EQ(file[0]["faces"], (Rows{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(file[1]["faces"], (Rows{{0, 1, 2}}));
}

TEST_F(SurfaceFiles, PlyHasFieldsAndColours) {
  const nlohmann::json file = seen("ply", store::ply_of(surfaces(), "two\nlines"));
  EXPECT_EQ(file["comments"],
            (std::vector<std::string>{"two lines", "object 0 is soft ball", "object 1 is tool"}));
  EXPECT_EQ(file["x"], (std::vector<float>{0, 1, 1, 0, 0.1f, 1, 0}));
  EXPECT_EQ(file["y"], (std::vector<float>{0, 0, 1, 1, 0, 1.f / 3.f, 1}));
  EXPECT_EQ(file["z"], (std::vector<float>{0, 0, 0, 0.5f, 2, 2, -1e-7f}));
  EXPECT_EQ(file["red"], (std::vector<int>{255, 0, 0, 1, 9, 9, 9}));
  EXPECT_EQ(file["green"], (std::vector<int>{0, 255, 0, 2, 9, 9, 9}));
  EXPECT_EQ(file["blue"], (std::vector<int>{0, 0, 255, 3, 9, 9, 9}));
  EXPECT_EQ(file["displacement"], (std::vector<float>{0, 0.25f, 0.5f, 0.75f, 0, 0, 0}));
  EXPECT_EQ(file["stress"], (std::vector<float>{1, 2, 3, 4, 0, 0, 0}));
  EXPECT_EQ(file["object"], (std::vector<int>{0, 0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(file["faces"], (Rows{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}));
}

TEST_F(SurfaceFiles, RefuseWhatDoesNotFitTogether) {
  auto broken = surfaces();
  broken[0].faces(0, 0) = 4;
  EXPECT_THROW(store::obj_of(broken, ""), InternalError);
  broken = surfaces();
  broken[1].colours.pop_back();
  EXPECT_THROW(store::ply_of(broken, ""), InternalError);
}

/// Two tetrahedra on a common face have six other faces; each is oriented outwards.
TEST(PartSurface, IsTheBoundaryOfTetrahedra) {
  const store::RunPart body = sample_run::parts()[0];
  const store::PartSurface found = store::part_surface(body);
  ASSERT_EQ(found.faces.cols(), 6);
  const Vec3 middle = body.reference.rowwise().mean();
  for (const auto& face : found.faces.colwise()) {
    const auto p = [&](int corner) -> Vec3 {
      return body.reference.col(found.node_of_vertex[static_cast<std::size_t>(face[corner])]);
    };
    EXPECT_GT((p(1) - p(0)).cross(p(2) - p(0)).dot(p(0) - middle), 0.0);
  }
}

TEST(PartSurface, IsAToolAsItIs) {
  const store::PartSurface found = store::part_surface(sample_run::parts()[1]);
  EXPECT_EQ(found.node_of_vertex, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(found.faces, sample_run::parts()[1].faces);
}

}  // namespace
