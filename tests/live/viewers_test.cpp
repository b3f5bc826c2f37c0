#include "live/viewers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "live/page_hands.h"
#include "palpate/loop/world.h"
#include "small_scene.h"

namespace palpate::live {
namespace {

class ViewersOfAScene : public testing::Test {
 protected:
  ViewersOfAScene() : viewers(controls, {"small", "other"}) {
    const scene::Description description = small_scene();
    const auto world = loop::assemble(description);
    mailbox = std::make_shared<HandleMailbox>();
    scene =
        std::make_shared<LiveScene>(*world, "small", sliders_of(description, {}), HandleMailboxes{mailbox});
    viewers.show(scene);
  }
  std::string send(int viewer, std::string_view text) { return viewers.receive(viewer, text, now).notice; }
  bool moved() { return std::exchange(seen, mailbox->latest().position[2]) != mailbox->latest().position[2]; }

  Controls controls;
  Viewers viewers;
  std::shared_ptr<HandleMailbox> mailbox;
  std::shared_ptr<LiveScene> scene;
  double now = 100.0, seen = 0.0;
};

constexpr const char* kMove = R"({"type":"handle","hand":0,"position":[0,0,%],"rotation":[1,0,0,0]})";
std::string move(double z) {
  std::string out = kMove;
  return out.replace(out.find('%'), 1, std::to_string(z));
}

TEST_F(ViewersOfAScene, OnlyTheHolderMovesTheHandle) {
  const int one = viewers.add(), two = viewers.add();
  send(one, move(0.01));
  EXPECT_FALSE(moved()) << "nobody holds it";
  EXPECT_EQ(send(one, R"({"type":"take"})"), "");
  EXPECT_STREQ(viewers.place_of(one).holder, "you");
  EXPECT_STREQ(viewers.place_of(two).holder, "other");
  EXPECT_NE(send(two, R"({"type":"take"})").find("another viewer holds the handle"), std::string::npos);
  send(two, move(0.02));
  EXPECT_FALSE(moved());
  send(one, move(0.03));
  EXPECT_TRUE(moved());
  EXPECT_EQ(mailbox->latest().position[2], 0.03);
  send(one, R"({"type":"handle","hand":1,"position":[0,0,0.5],"rotation":[1,0,0,0]})");
  EXPECT_FALSE(moved()) << "there is no such hand";
  viewers.remove(one);
  EXPECT_STREQ(viewers.place_of(two).holder, "nobody");
  EXPECT_EQ(send(two, R"({"type":"take"})"), "");
  send(two, R"({"type":"drop"})");
  EXPECT_STREQ(viewers.place_of(two).holder, "nobody");
}

TEST_F(ViewersOfAScene, TheHolderMovesEveryHandThatThePageMoves) {
  const auto left = std::make_shared<HandleMailbox>();
  scene->handles = {mailbox, nullptr, left};
  const int one = viewers.add();
  send(one, R"({"type":"take"})");
  send(one, R"({"type":"handle","hand":2,"position":[0,0,0.7],"rotation":[1,0,0,0]})");
  EXPECT_FALSE(moved());
  EXPECT_EQ(left->latest().position[2], 0.7);
  for (const char* hand : {"1", "3", "255"})  // the device of the scene moves it; there is none
    EXPECT_EQ(send(one, fmt::format(R"({{"type":"handle","hand":{},"position":[0,0,0.9],)"
                                    R"("rotation":[1,0,0,0]}})",
                                    hand)),
              "");
  EXPECT_EQ(left->latest().position[2], 0.7);
  EXPECT_FALSE(moved());
  EXPECT_EQ(viewers.bad(), 0);
}

TEST(PageHands, EveryHandIsThePagesUnlessItIsMovedFromOutside) {
  const PageHands both = page_hands_of(small_scene(kSecondHand));
  ASSERT_EQ(both.devices.size(), 2U);
  ASSERT_EQ(both.mailboxes.size(), 2U);
  EXPECT_EQ(both.devices[1]->sample(0.0).pose.translation, Vec3(-0.06, 0.0, 0.0));
  both.mailboxes[1]->publish(HandleTarget::of({Quat::Identity(), {-0.05, 0.0, 0.0}}, 0));
  for (int i = 1; i <= 500; ++i) both.devices[1]->sample(1e-3 * i);
  EXPECT_NEAR(both.devices[1]->position().x(), -0.05, 1e-9);
  EXPECT_EQ(both.devices[0]->sample(0.5).pose.translation, Vec3(0.0, 0.0, 0.045));

  scene::Description outside = small_scene(kSecondHand);
  outside.device->type = outside.hands[0].device.type = "udp";
  outside.hands[0].device.port = 47000;
  const PageHands first = page_hands_of(outside);
  EXPECT_TRUE(first.devices[0] && first.mailboxes[0]) << "the page moves the first hand always";
  ASSERT_EQ(first.devices.size(), 2U);
  EXPECT_FALSE(first.devices[1] || first.mailboxes[1]);
  EXPECT_TRUE(page_hands_of(small_scene({"tool.radius_m=0.01"})).devices[0]->is_live());
}

TEST_F(ViewersOfAScene, WhileSomebodyHoldsTheHandleOthersChangeNothing) {
  const int one = viewers.add(), two = viewers.add();
  send(two, R"({"type":"pause","on":true})");
  EXPECT_TRUE(controls.pause()) << "nobody holds the handle";
  send(one, R"({"type":"take"})");
  for (const char* text : {R"({"type":"pause","on":false})", R"({"type":"reset"})",
                           R"({"type":"record","on":true})", R"({"type":"open","scene":"other"})",
                           R"({"type":"set","key":"tool.coupling.stiffness_n_m","value":200})"})
    EXPECT_NE(send(two, text).find("another viewer"), std::string::npos) << text;
  EXPECT_TRUE(controls.pause());
  EXPECT_FALSE(controls.take().any());
  send(one, R"({"type":"record","on":true})");
  EXPECT_TRUE(controls.leave());
  EXPECT_EQ(controls.take().record, true);
  EXPECT_FALSE(controls.leave());
}

TEST_F(ViewersOfAScene, SlidersHaveBoundsAndYoungsModulusChangesAtOnce) {
  const int one = viewers.add();
  EXPECT_NE(
      send(one, R"({"type":"set","key":"tool.coupling.stiffness_n_m","value":1e6})").find("must lie in"),
      std::string::npos);
  EXPECT_NE(send(one, R"({"type":"set","key":"scene.duration_s","value":1})").find("no slider"),
            std::string::npos);
  EXPECT_FALSE(controls.take().any());
  EXPECT_EQ(send(one, R"({"type":"set","key":"tool.coupling.stiffness_n_m","value":200})"), "");
  EXPECT_TRUE(controls.leave()) << "the scene is assembled anew";
  EXPECT_EQ(controls.take().values.at("tool.coupling.stiffness_n_m"), 200.0);
  EXPECT_EQ(send(one, R"({"type":"set","key":"body.0.youngs_modulus_pa","value":2e4})"), "");
  EXPECT_FALSE(controls.leave());
  EXPECT_EQ(scene->moduli[0].load(), 2e4);
  EXPECT_NE(scene->description.find("\"value\":20000.0"), std::string::npos) << "for viewers that come later";
  EXPECT_EQ(controls.take().values.at("body.0.youngs_modulus_pa"), 2e4) << "for the next assembly";
  scene->is_recorded = true;
  EXPECT_NE(send(one, R"({"type":"set","key":"body.0.youngs_modulus_pa","value":3e4})").find("recording"),
            std::string::npos);
  EXPECT_EQ(scene->moduli[0].load(), 2e4);
}

TEST_F(ViewersOfAScene, OnlyListedScenesAreOpened) {
  const int one = viewers.add();
  EXPECT_NE(send(one, R"({"type":"open","scene":"/etc/passwd"})").find("no scene"), std::string::npos);
  EXPECT_FALSE(controls.take().any());
  EXPECT_EQ(send(one, R"({"type":"open","scene":"other"})"), "");
  EXPECT_EQ(controls.take().open, "other");
}

TEST_F(ViewersOfAScene, TwentyBadMessagesDisconnect) {
  const int one = viewers.add();
  for (int i = 1; i <= 19; ++i) EXPECT_FALSE(viewers.receive(one, "rubbish", now).close) << i;
  EXPECT_TRUE(viewers.receive(one, std::nullopt, now).close);
  EXPECT_EQ(viewers.bad(), 20);
}

TEST_F(ViewersOfAScene, MessagesBeyondTheRateAreDropped) {
  const int one = viewers.add();
  send(one, R"({"type":"take"})");
  for (int i = 0; i < 1000; ++i) send(one, move(0.04));
  EXPECT_EQ(viewers.dropped(), 701) << "300 at once";
  now += 0.5;
  for (int i = 0; i < 1000; ++i) send(one, move(0.05));
  EXPECT_EQ(viewers.dropped(), 701 + 850) << "150 in half a second";
}

TEST_F(ViewersOfAScene, EightMayWatch) {
  for (int i = 0; i < 8; ++i) {
    EXPECT_FALSE(viewers.is_full());
    viewers.add();
  }
  EXPECT_TRUE(viewers.is_full());
}

}  // namespace
}  // namespace palpate::live
