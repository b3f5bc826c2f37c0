// How gaps are found: method = "auto" takes nearest points; who makes images: "image" takes a GPU where the
// machine has one, else the processor; a method that is named is what it says.
#include <gtest/gtest.h>

#include <tuple>

#include "contact/depth_image.h"
#include "contact/gpu_hardware.h"
#include "loop/small_scenes.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "palpate/loop/summary.h"

using namespace palpate;

namespace {

int gpu_images = 0;  ///< made by stand_in or refused by none
std::unique_ptr<contact::DepthImage> stand_in() {
  ++gpu_images;
  return contact::make_cpu_image();
}
std::unique_ptr<contact::DepthImage> none() {
  ++gpu_images;
  fail("no EGL device; install libegl1");
}

/// A machine with a GPU or without one, whatever this one has.
class MethodChoice : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu_images = 0;
    contact::gpu_image_maker() = stand_in;
  }
  void TearDown() override {
    contact::gpu_image_maker() = maker_;
    contact::gpu_probe() = probe_;
  }
  void set_hardware(bool there) {
    contact::gpu_probe() = there ? +[] { return true; } : +[] { return false; };
  }
  /// Two blocks that touch, after one period.
  std::unique_ptr<loop::World> after_a_period(const std::string& method) {
    scene::Description d = small_scenes::held_block();
    d.bodies.push_back(d.bodies[0]);
    d.bodies[1].name = "upper";
    d.bodies[1].position_m.z() += 0.0195;
    d.bodies[1].attachments.clear();
    ContactSpec contact;
    contact.first = "block";
    contact.second = "upper";
    contact.method = method;
    contact.stiffness_pa_m = 1e6;
    d.contacts.push_back(contact);
    d.exchange.exchange_period_s = d.exchange.contact_refresh_s = d.duration_s = 0.01;
    auto world = loop::assemble(d);
    result_ = loop::run(*world, {});
    EXPECT_TRUE(result_.status.ok()) << result_.status.message;
    EXPECT_GT(world->contact->samples().size(), 10u);
    return world;
  }
  loop::RunResult result_;

 private:
  contact::MakeImage maker_ = contact::gpu_image_maker();
  contact::GpuProbe probe_ = contact::gpu_probe();
};

}  // namespace

TEST_F(MethodChoice, AutoTakesNearestPoints) {
  set_hardware(true);
  EXPECT_EQ(after_a_period("auto")->contact->methods().at(0), "distance");
  EXPECT_EQ(gpu_images, 0);
}

TEST_F(MethodChoice, AnImageIsTheGpusWhereThereIsOne) {
  for (const auto& [method, hardware, expected] :
       {std::tuple{"image", true, "gpu"}, std::tuple{"image", false, "cpu"}, std::tuple{"cpu", true, "cpu"},
        std::tuple{"gpu", false, "gpu"}, std::tuple{"exact", true, "exact"}}) {
    gpu_images = 0;
    set_hardware(hardware);
    const auto world = after_a_period(method);
    const std::string what = std::string(method) + (hardware ? " with a GPU" : " without one");
    EXPECT_EQ(world->contact->methods().at(0), expected) << what;
    EXPECT_EQ(gpu_images > 0, std::string(expected) == "gpu") << what;
    EXPECT_TRUE(world->contact->fallbacks().at(0).empty()) << what;
  }
}

// A GPU that is there and cannot be opened: the run goes on, and its summary says so.
TEST_F(MethodChoice, AnImageFallsBackAndSaysSo) {
  contact::gpu_image_maker() = none;
  set_hardware(true);
  const auto world = after_a_period("image");
  EXPECT_EQ(gpu_images, 1);
  EXPECT_EQ(world->contact->methods().at(0), "cpu");
  store::Summary summary = loop::summarise(*world, result_, 0.0);
  std::string why;
  for (const auto& [name, value] : summary.section("images").values)
    if (name.find("why not by the GPU") != std::string::npos) why = std::get<std::string>(value);
  EXPECT_NE(why.find("install libegl1"), std::string::npos) << why;
  EXPECT_THROW(after_a_period("gpu"), Error) << "one that is named is not replaced";
}
