#include "model/quality_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/mesh/quality.h"
#include "surfaces.h"

using namespace palpate;
using surfaces::refusal;

namespace {

TetMesh regular() {
  TetMesh out;
  out.nodes = (Points(3, 4) << 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1, 1).finished();
  out.tets = (Tets(4, 1) << 0, 1, 2, 3).finished();
  Vec3 a = out.nodes.col(1) - out.nodes.col(0), b = out.nodes.col(2) - out.nodes.col(0),
       c = out.nodes.col(3) - out.nodes.col(0);
  if (a.cross(b).dot(c) < 0) out.tets.row(0).swap(out.tets.row(1));
  return out;
}

TEST(QualityGate, RegularTetrahedron) {
  const double edge = 2 * std::sqrt(2.0), volume = edge * edge * edge / (6 * std::sqrt(2.0));
  const model::TetQuality q = model::measure_quality(regular(), volume);
  EXPECT_NEAR(q.smallest_dihedral_deg, std::acos(1.0 / 3) * 180 / M_PI, 1e-10);
  EXPECT_NEAR(q.largest_dihedral_deg, std::acos(1.0 / 3) * 180 / M_PI, 1e-10);
  EXPECT_NEAR(q.worst_aspect, 1.0, 1e-12);
  EXPECT_NEAR(q.mean_edge, edge, 1e-12);
  EXPECT_NEAR(q.volume_error, 0.0, 1e-12);
  EXPECT_EQ(refusal([&] { model::pass_gate(regular(), q, {}, "a.obj"); }), "accepted");
}

TEST(QualityGate, CornerTetrahedron) {
  // Three faces at right angles; the fourth meets them at acos(1/sqrt 3). Inscribed radius 3 V / A = (1/2) /
  // (3/2 + sqrt(3)/2).
  const TetMesh corner = mesh::corner_tet(Vec3::Ones());
  const model::TetQuality q = model::measure_quality(corner, 1.0 / 6);
  EXPECT_NEAR(q.smallest_dihedral_deg, std::acos(1 / std::sqrt(3.0)) * 180 / M_PI, 1e-10);
  EXPECT_NEAR(q.largest_dihedral_deg, 90.0, 1e-10);
  EXPECT_NEAR(q.worst_aspect, std::sqrt(2.0) / (2 * std::sqrt(6.0) * 0.5 / (1.5 + std::sqrt(3.0) / 2)),
              1e-12);
}

TEST(QualityGate, RefusesASliverWithItsPlace) {
  TetMesh flat = regular();
  flat.nodes.row(2) *= 0.05;
  const model::TetQuality q =
      model::measure_quality(flat, mesh::enclosed_volume(mesh::boundary(flat).surface));
  const std::string message = refusal([&] { model::pass_gate(flat, q, {}, "a.obj"); });
  EXPECT_NE(message.find("a.obj: tetrahedron 0 at (0, 0, 0) m has a dihedral angle of "), std::string::npos)
      << message;
  EXPECT_NE(message.find("must have at least 8"), std::string::npos) << message;
}

TEST(QualityGate, RefusesAVolumeThatIsOff) {
  const double volume = model::measure_quality(regular(), 1.0).volume;
  EXPECT_EQ(refusal([&] {
              model::pass_gate(regular(), model::measure_quality(regular(), volume / 1.009), {}, "a.obj");
            }),
            "accepted");
  const std::string message = refusal(
      [&] { model::pass_gate(regular(), model::measure_quality(regular(), volume / 1.011), {}, "a.obj"); });
  EXPECT_NE(message.find("an error of 1.10 %, must be within 1 %"), std::string::npos) << message;
  EXPECT_NE(refusal([&] {
              model::pass_gate(TetMesh{}, model::measure_quality(TetMesh{Points(3, 0), Tets(4, 0)}, 1.0), {},
                               "a.obj");
            }),
            "accepted");
}

TEST(QualityGate, SaysHowToTakeTetrahedraOfAFile) {
  TetMesh flat = regular();
  flat.nodes.row(2) *= 0.05;
  const model::TetQuality q =
      model::measure_quality(flat, mesh::enclosed_volume(mesh::boundary(flat).surface));
  model::QualityGate gate;
  gate.given = true;
  const std::string message = refusal([&] { model::pass_gate(flat, q, gate, "a.msh"); });
  EXPECT_NE(message.find("--remesh"), std::string::npos) << message;
  EXPECT_NE(message.find("--accept-angles"), std::string::npos) << message;
}

TEST(QualityGate, AWrongVolumeIsToldWithItsPlace) {
  TriMesh surface = mesh::boundary(regular()).surface;
  surface.vertices.conservativeResize(3, 5);
  surface.vertices.col(4) = Vec3(7, 8, 9);  // far from all nodes
  const std::string message = refusal(
      [&] { model::pass_gate(regular(), model::measure_quality(regular(), 1.0), {}, "a.obj", surface); });
  EXPECT_NE(message.find("at (7, 8, 9) m"), std::string::npos) << message;
}

TEST(QualityGate, TetrahedraOnOneSideOfTheirFaceAreRefused) {
  TetMesh two = mesh::corner_tet(Vec3::Ones());
  two.nodes.conservativeResize(3, 5);
  two.tets.conservativeResize(4, 2);
  // On the far side of the slanted face x + y + z = 1: valid.
  two.nodes.col(4) = Vec3(1, 1, 1);
  two.tets.col(1) << 1, 2, 3, 4;
  ASSERT_GT(mesh::tet_volume(two, 1), 0);
  EXPECT_EQ(refusal([&] { model::check_sides(two, "a.msh"); }), "accepted");
  // On the same side as the first one, with its nodes in the order of positive volume.
  two.nodes.col(4) = Vec3(0.1, 0.1, 0.1);
  two.tets.col(1) << 2, 1, 3, 4;
  ASSERT_GT(mesh::tet_volume(two, 1), 0);
  EXPECT_NE(
      refusal([&] { model::check_sides(two, "a.msh"); }).find("tetrahedra 0 and 1 lie on the same side"),
      std::string::npos);
}

}  // namespace
