// Regions of a body with separate materials: by box and sphere, and by the names of a mesh file and of a
// model file.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/counters.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/loop/world.h"
#include "palpate/mesh/quality.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

class Regions : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  TemporaryFolder folder_;
};

/// Region of the upper half of the held block, with the given settings.
RegionSpec upper_half() {
  RegionSpec out;
  out.name = "lid";
  out.region = Selection::kBox;
  out.box_min_m = Vec3(-1, -1, 0.01);
  out.box_max_m = Vec3::Ones();
  return out;
}

scene::Description with(RegionSpec region) {
  scene::Description d = held_block();
  d.gravity_m_s2 = Vec3(0, 0, -9.81);
  d.bodies[0].regions.push_back(std::move(region));
  return d;
}

VecX end_of(const scene::Description& d) {
  const auto world = loop::assemble(d);
  EXPECT_TRUE(loop::run(*world, {}).status.ok());
  return world->state.q();
}

std::string refusal(const scene::Description& d) {
  try {
    loop::assemble(d);
  } catch (const Error& e) { return e.what(); }
  return "accepted";
}

}  // namespace

TEST_F(Regions, WeighWhatTheirDensitySays) {
  RegionSpec lid = upper_half();
  lid.density_kg_m3 = 3500.0;
  for (const MassMatrix mass : {MassMatrix::kLumped, MassMatrix::kConsistent}) {
    scene::Description d = with(lid);
    d.bodies[0].mass = mass;
    const auto world = loop::assemble(d);
    const loop::Body& body = world->bodies[0];
    const double half = 0.04 * 0.04 * 0.01;
    EXPECT_NEAR(body.masses.sum(), half * (1000.0 + 3500.0), 1e-12);
    ASSERT_EQ(body.regions.size(), 1u);
    double volume = 0.0;
    for (const int tet : body.regions[0].tets) volume += mesh::tet_volume(body.rest, tet);
    EXPECT_NEAR(volume, half, 1e-15);
    EXPECT_NEAR(body.regions[0].volume, half, 1e-15);
    EXPECT_EQ(body.term->materials()[1].youngs_modulus, 1e4) << "what is not given is the body's";
    // Kinetic energy of a translation: the inertia term uses the same mass.
    world->state.u().setZero();
    for (Eigen::Index i = 0; i < world->state.u().size(); i += 3) world->state.u()[i] = 1.0;
    EXPECT_NEAR(world->system.kinetic_energy(world->state.view()), 0.5 * half * 4500.0, 1e-12);
  }
}

TEST_F(Regions, OfTheBodysMaterialChangeNothing) {
  RegionSpec lid = upper_half();
  lid.youngs_modulus_pa = 1e4;
  for (const Volumetric volumetric : {Volumetric::kElement, Volumetric::kNodal}) {
    scene::Description divided = with(lid);
    divided.integrator.linear_solver = "cholmod";  // accurate to rounding
    scene::Description whole = divided;
    divided.bodies[0].volumetric = whole.bodies[0].volumetric = volumetric;
    // averages of the dilatation end at a border: at 0.2 no share is averaged
    divided.bodies[0].poissons_ratio = whole.bodies[0].poissons_ratio =
        volumetric == Volumetric::kNodal ? 0.2 : 0.45;
    whole.bodies[0].regions.clear();
    const VecX a = end_of(divided), b = end_of(whole);
    EXPECT_LT((a - b).norm(), 1e-12 * b.norm());
    const long made = counters::counter("loop.regions");
    loop::assemble(whole);
    EXPECT_EQ(counters::counter("loop.regions"), made) << "a scene that names no region makes none";
  }
}

TEST_F(Regions, AStifferLidSagsLess) {
  RegionSpec lid = upper_half();
  lid.youngs_modulus_pa = 1e7;
  const VecX soft = end_of(with(upper_half())), stiff = end_of(with(lid));
  const auto world = loop::assemble(with(lid));
  const Points rest = world->bodies[0].placed;
  double soft_stretch = 0.0, stiff_stretch = 0.0;  // stretch of the lid along x
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    if (rest(2, i) < 0.0199) continue;
    soft_stretch = std::max(soft_stretch, (soft.segment<3>(3 * i) - rest.col(i)).head<2>().norm());
    stiff_stretch = std::max(stiff_stretch, (stiff.segment<3>(3 * i) - rest.col(i)).head<2>().norm());
  }
  EXPECT_GT(soft_stretch, 1e-5);
  EXPECT_LT(stiff_stretch, 0.05 * soft_stretch);
}

TEST_F(Regions, ChangeAlongWithTheBodyOrAlone) {
  RegionSpec lid = upper_half(), own = upper_half();
  lid.density_kg_m3 = 2000.0;
  own.youngs_modulus_pa = 5e4;
  const auto follows = loop::assemble(with(lid)), keeps = loop::assemble(with(own));
  const auto moduli = [](const loop::World& world) {
    return std::pair(world.bodies[0].term->materials()[0].youngs_modulus,
                     world.bodies[0].term->materials()[1].youngs_modulus);
  };
  follows->set_youngs_modulus(follows->bodies[0], 2e4);
  keeps->set_youngs_modulus(keeps->bodies[0], 2e4);
  EXPECT_EQ(moduli(*follows), std::pair(2e4, 2e4));
  EXPECT_EQ(moduli(*keeps), std::pair(2e4, 5e4));
  follows->set_youngs_modulus(follows->bodies[0], 7e4, "lid");
  EXPECT_EQ(moduli(*follows), std::pair(2e4, 7e4));
  follows->set_youngs_modulus(follows->bodies[0], 3e4);
  EXPECT_EQ(moduli(*follows), std::pair(3e4, 7e4)) << "from then on it has its own";
  try {
    follows->set_youngs_modulus(follows->bodies[0], 7e4, "lit");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(
        std::string(e.what()).find("no region \"lit\" with a separate material (did you mean \"lid\"?)"),
        std::string::npos)
        << e.what();
  }
  EXPECT_THROW(follows->set_youngs_modulus(follows->bodies[0], -1.0, "lid"), Error);

  // Changed during a run: the final state equals that of a run with the modulus from the start, since there
  // are no forces until the change.
  scene::Description changed = with(own), fresh = with(own);
  changed.bodies[0].changes = {{0.02, 3e5, "lid"}};
  changed.gravity_m_s2 = fresh.gravity_m_s2 = Vec3::Zero();
  changed.bodies[0].velocity_m_s = fresh.bodies[0].velocity_m_s = Vec3(0.1, 0, 0);
  EXPECT_GT((end_of(changed) - end_of(fresh)).norm(), 1e-6);
}

TEST_F(Regions, OfAMeshFileGoByName) {
  // Two tetrahedra on one face: volumes 1/6 and 1/3.
  const std::string msh =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 1 \"tissue\"\n3 2 "
      "\"bone\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n"
      "$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 2 2 3 4 5\n$EndElements\n";
  std::ofstream(at("two.msh")) << msh;
  scene::Description d = held_block();
  d.path = at("scene.toml");
  d.bodies[0].mesh = {};
  d.bodies[0].mesh.file = "two.msh";
  d.bodies[0].attachments.clear();
  {
    // without a material in the scene the region has the body's material, and is still listed
    const auto world = loop::assemble(d);
    ASSERT_EQ(world->bodies[0].regions.size(), 2u);
    EXPECT_EQ(world->bodies[0].regions[1].material, 0);
    EXPECT_EQ(world->bodies[0].term->materials().size(), 1u);
    EXPECT_NEAR(world->bodies[0].masses.sum(), 500.0, 1e-9);
  }
  RegionSpec bone;
  bone.name = "bone";
  bone.density_kg_m3 = 4000.0;
  d.bodies[0].regions = {bone};
  EXPECT_NEAR(loop::assemble(d)->bodies[0].masses.sum(), 1000.0 / 6.0 + 4000.0 / 3.0, 1e-9);
  d.bodies[0].regions[0].name = "bones";
  EXPECT_NE(refusal(d).find("two.msh has no region \"bones\" (did you mean \"bone\"?)"), std::string::npos)
      << refusal(d);
  d.bodies[0].regions[0].name = "bone";
  d.bodies[0].regions[0].region = Selection::kSphere;
  d.bodies[0].regions[0].radius_m = 1.0;
  EXPECT_NE(refusal(d).find("region \"bone\" also exists in two.msh; give the sphere another name"),
            std::string::npos)
      << refusal(d);
  d.bodies[0].regions[0].name = "nothing";
  d.bodies[0].regions[0].centre_m = Vec3::Constant(9);
  EXPECT_NE(refusal(d).find("region \"nothing\" contains no tetrahedron"), std::string::npos) << refusal(d);

  // An element in two regions of the scene belongs to the last one.
  RegionSpec all = bone;
  all.name = "all";
  all.region = Selection::kSphere;
  all.radius_m = 10.0;
  all.density_kg_m3 = 2000.0;
  d.bodies[0].regions = {all, bone};
  EXPECT_NEAR(loop::assemble(d)->bodies[0].masses.sum(), 2000.0 / 6.0 + 4000.0 / 3.0, 1e-9);
  d.bodies[0].regions = {bone, all};
  EXPECT_NE(refusal(d).find("region \"bone\" contains no tetrahedron"), std::string::npos) << refusal(d);

  store::write_mesh(at("plain.h5"), loop::assemble(d =
                                                       [&] {
                                                         scene::Description e = d;
                                                         e.bodies[0].regions.clear();
                                                         return e;
                                                       }())
                                        ->bodies[0]
                                        .rest);
  d.bodies[0].mesh.file = "plain.h5";
  d.bodies[0].regions = {bone};
  EXPECT_NE(refusal(d).find("plain.h5 has no regions; create them with `palpate model --region`"),
            std::string::npos)
      << refusal(d);
}

TEST_F(Regions, OfAModelFileBringTheirFactors) {
  scene::Description d = held_block();
  d.path = at("scene.toml");
  store::ModelFile file;
  file.model.name = "block";
  file.model.tets = loop::assemble(d)->bodies[0].rest;
  const auto tets = static_cast<int>(file.model.tets.tets.cols());
  file.model.regions = {{"hard", {0, 3, 4}, 20.0, 2.0}, {"plain", {1, 5, tets - 1}}};
  store::write_model(at("block.h5"), file);
  d.bodies[0].mesh = {};
  d.bodies[0].mesh.file = "block.h5";
  auto world = loop::assemble(d);
  EXPECT_EQ(world->bodies[0].term->materials().size(), 2u) << "a region that is the body's needs no material";
  EXPECT_EQ(world->bodies[0].term->materials()[1].youngs_modulus, 20e4);
  EXPECT_EQ(world->bodies[0].term->materials()[1].density, 2000.0);
  EXPECT_EQ(world->bodies[0].material_of_element[3], 1);
  EXPECT_EQ(world->bodies[0].material_of_element[5], 0);
  world->set_youngs_modulus(world->bodies[0], 3e4);
  EXPECT_EQ(world->bodies[0].term->materials()[1].youngs_modulus, 60e4);
  RegionSpec hard;
  hard.name = "hard";
  hard.youngs_modulus_pa = 7e5;
  d.bodies[0].regions = {hard};
  world = loop::assemble(d);
  EXPECT_EQ(world->bodies[0].term->materials()[1].youngs_modulus, 7e5);
  EXPECT_EQ(world->bodies[0].term->materials()[1].density, 2000.0)
      << "of the file, as the scene says nothing of it";
}
