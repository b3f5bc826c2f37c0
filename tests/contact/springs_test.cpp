// Stiffness per area or per point.
#include "images.h"
#include "palpate/contact/pressure.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

constexpr double kDepth = 0.01;

/// A flat sheet of 1 m x 1 m at height z, with columns x rows vertices.
TriMesh sheet(int columns, int rows, double z, bool faces_down) {
  TriMesh mesh;
  mesh.vertices.resize(3, columns * rows);
  mesh.faces.resize(3, 2 * (columns - 1) * (rows - 1));
  const auto at = [&](int i, int j) { return i * rows + j; };
  Eigen::Index f = 0;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      mesh.vertices.col(at(i, j)) =
          Vec3(static_cast<double>(i) / (columns - 1), static_cast<double>(j) / (rows - 1), z);
      if (i + 1 == columns || j + 1 == rows) continue;
      mesh.faces.col(f++) = Eigen::Vector3i(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.faces.col(f++) = Eigen::Vector3i(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  if (faces_down) mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

ContactSpec spec(const std::string& spring) {
  ContactSpec out;
  out.spring = spring;
  out.stiffness_pa_m = 4e4;
  out.damping_pa_s_m = 50.0;
  out.stiffness_n_m = 20.0;
  out.damping_n_s_m = 0.3;
  return out;
}

/// Response of a sheet that sinks into z = 0 at `speed`; the stiffness is against its rigid motion.
struct Response {
  double lift, energy, power, stiffness;
};
Response response(const TriMesh& mesh, const ContactSpec& law, bool image, double speed) {
  SurfaceWorld world(image ? closed_by_cone(mesh, Vec3(0.5, 0.5, 1.0)) : mesh);
  for (Eigen::Index i = 8; i < world.state.u().size(); i += 3) world.state.u()[i] = -speed;
  contact::ContactForce term;
  const auto frame = contact::fixed_frame();
  term.add_frame(frame);
  if (image) {
    const contact::ImageOptions options = image_options(128, 0.02);
    TriMesh floor = sheet(3, 3, 0.0, false);
    floor.vertices = (2.0 * floor.vertices).colwise() - Vec3(0.5, 0.5, 0.0);
    floor = closed_by_cone(floor, Vec3(0.5, 0.5, -1.0));
    term.add_pair(contact::make_image_source(world.surface, floor, 0, frame, options), law);
  } else {
    term.add_pair(contact::make_plane_source(world.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 0.02),
                  law);
  }
  term.refresh(world.state.view());
  const VecX f = force(term, world.state);
  VecX down = VecX::Zero(f.size()), K = VecX::Zero(f.size());
  for (Eigen::Index i = 8; i < f.size(); i += 3) down[i] = -1.0;
  term.apply_tangent(world.state.view(), 1.0, 0.0, down, K);
  return {-f.dot(down), term.energy(world.state.view()), term.dissipated_power(world.state.view()),
          down.dot(K)};
}

}  // namespace

// With twice the vertices, per-area values do not change and per-point values double. By hand, for N vertices
// over 1 m^2 at a depth d that grows at speed v:
//   force k d + c v, energy k d^2/2, dissipated power c v^2, stiffness k,     times 1 m^2, or times N
TEST(Springs, OfAreaDoNotSeeTheMeshOfPointsCountIt) {
  constexpr double kSpeed = 0.2;
  int checked = 0;
  for (const bool image : {false, true})
    for (const auto& [columns, rows] : {std::pair{10, 9}, std::pair{20, 9}, std::pair{20, 18}}) {
      const TriMesh mesh = sheet(columns, rows, -kDepth, true);
      const auto expect = [&](const char* spring, double times, double k, double c) {
        const Response r = response(mesh, spec(spring), image, kSpeed);
        EXPECT_NEAR(r.lift / (times * (k * kDepth + c * kSpeed)), 1.0, 1e-6) << spring << image;
        EXPECT_NEAR(r.energy / (times * 0.5 * k * kDepth * kDepth), 1.0, 1e-6) << spring << image;
        EXPECT_NEAR(r.power / (times * c * kSpeed * kSpeed), 1.0, 1e-6) << spring << image;
        EXPECT_NEAR(r.stiffness / (times * k), 1.0, 1e-6) << spring << image;
        ++checked;
      };
      expect("per_area", 1.0, 4e4, 50.0);
      expect("per_point", columns * rows, 20.0, 0.3);
    }
  EXPECT_EQ(checked, 12);
}

TEST(SpringLaw, RefusesWhatIsNoSpring) {
  const auto message = [](const ContactSpec& law) {
    try {
      contact::pressure(law, -1e-3, 0.0);
    } catch (const Error& e) { return std::string(e.what()); }
    return std::string("accepted");
  };
  EXPECT_EQ(message(spec("per_point")), "accepted");
  EXPECT_NE(message(spec("per_pont")).find("unknown spring \"per_pont\" (did you mean \"per_point\"?)"),
            std::string::npos);
  ContactSpec bad = spec("per_point");
  bad.stiffness_n_m = -1.0;
  EXPECT_NE(message(bad).find("stiffness_n_m = -1 must be positive"), std::string::npos) << message(bad);
  bad = spec("per_point");
  bad.damping_n_s_m = -1.0;
  EXPECT_NE(message(bad).find("damping_n_s_m = -1"), std::string::npos) << message(bad);
}
