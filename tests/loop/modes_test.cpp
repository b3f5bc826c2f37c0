#include "loop/modes.h"

#include <gtest/gtest.h>

#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/core/named_enum.h"
#include "palpate/store/run_file.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::small_scenes;

namespace {

TEST(ModesOfAScene, OfAHeldBlockScaleWithTheRootOfItsStiffness) {
  scene::Description d = held_block();
  const auto soft = loop::assemble(d);
  d.bodies[0].youngs_modulus_pa *= 4.0;
  const auto stiff = loop::assemble(d);
  const modes::Modes one = loop::find_modes(*soft, 5), other = loop::find_modes(*stiff, 5);
  EXPECT_TRUE(one.converged);
  for (int j = 0; j < 5; ++j) {
    EXPECT_GT(one.omega(j), 0.0);
    EXPECT_NEAR(other.omega(j), 2.0 * one.omega(j), 1e-9 * other.omega(j)) << j;
  }
}

TEST(ModesOfAScene, OfAFreeBlockBeginWithSixRigidMotionsWhereverItStandsAndLies) {
  for (const MassMatrix mass : {MassMatrix::kLumped, MassMatrix::kConsistent}) {
    scene::Description d = held_block();
    d.bodies[0].attachments.clear();
    d.bodies[0].mass = mass;
    const auto here = loop::assemble(d);
    d.bodies[0].position_m = Vec3(3.0, -2.0, 1.0);
    d.bodies[0].rotation_vector_rad = Vec3(0.3, -0.5, 1.0);
    const auto there = loop::assemble(d);
    const modes::Modes one = loop::find_modes(*here, 9), other = loop::find_modes(*there, 9);
    for (int j = 0; j < 6; ++j) {
      EXPECT_EQ(one.omega_squared[j], 0.0) << name_of(mass) << " " << j;
      EXPECT_EQ(other.omega_squared[j], 0.0) << name_of(mass) << " " << j;
    }
    for (int j = 6; j < 9; ++j)
      EXPECT_NEAR(other.omega(j), one.omega(j), 1e-8 * one.omega(j)) << name_of(mass) << " " << j;
  }
}

TEST(ModesOfAScene, NodalDilatationUnlocksThemAndAddsNoneOfZeroEnergy) {
  scene::Description d = held_block();
  d.bodies[0].attachments.clear();
  d.bodies[0].poissons_ratio = 0.4999;
  const auto locked = loop::assemble(d);
  d.bodies[0].volumetric = Volumetric::kNodal;
  const auto nodal = loop::assemble(d);
  d.bodies[0].poissons_ratio = 0.499;
  const auto softer = loop::assemble(d);
  const modes::Modes one = loop::find_modes(*locked, 14), other = loop::find_modes(*nodal, 14),
                     less = loop::find_modes(*softer, 14);
  EXPECT_TRUE(other.converged);
  EXPECT_FALSE(locked->bodies[0].dilatation);
  ASSERT_TRUE(nodal->bodies[0].dilatation);
  for (int j = 0; j < 14; ++j) {
    EXPECT_EQ(other.omega_squared[j] == 0.0, j < 6)
        << j << ": six rigid motions, and no other mode without energy";
    EXPECT_LE(other.omega_squared[j], one.omega_squared[j] * (1.0 + 1e-9))
        << j << ": averages never exceed what they average (Jensen), so no frequency rises (Weyl)";
    if (j >= 6) { EXPECT_GT(other.omega(j), 0.9 * less.omega(j)) << j; }
  }
}

#ifdef PALPATE_HAS_TOOL
TEST(ModesOfAScene, AToolThatPressesStiffensThem) {
  const auto free = loop::assemble(held_block()), pressed = loop::assemble(pressed_block(0.002)),
             above = loop::assemble(pressed_block(-0.01));
  const auto squares = [](loop::World& world) { return loop::find_modes(world, 8).omega_squared; };
  const VecX without = squares(*free), with = squares(*pressed);
  EXPECT_GT(with.sum(), 1.001 * without.sum());
  EXPECT_GE((with - without).minCoeff(), -1e-9 * without[0])
      << "a stiffness that is added lowers no frequency (Weyl)";
  EXPECT_LE((squares(*above) - without).cwiseAbs().maxCoeff(), 1e-9 * without[7]);
}
#endif

TEST(ModesOfAScene, AreWrittenOneAStep) {
  const auto world = loop::assemble(held_block());
  const modes::Modes modes = loop::find_modes(*world, 3);
  const TemporaryFolder folder;
  const std::string path = (folder / "modes.vtkhdf").string();
  loop::write_modes(*world, modes, path);
  const store::RunReader file(path);
  ASSERT_EQ(file.steps(), 3);
  EXPECT_EQ(file.times_s(), (std::vector<double>{1, 2, 3}));
  for (int j = 0; j < 3; ++j) {
    const Points moved = file.displacement(j),
                 by_position = modes.shapes.col(j).reshaped(3, file.point_count());
    Points shape(3, file.point_count());
    shape(Eigen::all, world->bodies[0].file_node) = by_position;
    EXPECT_NEAR(moved.colwise().norm().maxCoeff(), loop::kModeAmplitude * 0.04, 1e-12)
        << "a tenth of the longest edge";
    const double cosine = moved.reshaped().dot(shape.reshaped()) / (moved.norm() * shape.norm());
    EXPECT_NEAR(cosine, 1.0, 1e-12);
    EXPECT_LE((file.velocity(j) - modes.omega(j) * moved).norm(), 1e-9 * file.velocity(j).norm());
    EXPECT_GT(file.stress(j).maxCoeff(), 0.0);
  }
}

TEST(ModesOfAScene, AreOfSoftBodies) {
  scene::Description d = held_block();
  d.bodies.clear();
  const auto world = loop::assemble(d);
  EXPECT_THROW(loop::find_modes(*world, 3), Error);
}

}  // namespace
