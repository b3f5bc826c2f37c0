#include "live/messages.h"

#include <gtest/gtest.h>

#include <string>

namespace palpate::live {
namespace {

template <class Type>
bool is(const std::string& text) {
  const auto message = read_message(text);
  return message && std::holds_alternative<Type>(*message);
}

TEST(Messages, EachTypeIsRead) {
  EXPECT_TRUE(is<TakeHandle>(R"({"type":"take"})"));
  EXPECT_TRUE(is<DropHandle>(R"({"type":"drop"})"));
  EXPECT_TRUE(is<Reset>(R"({"type":"reset"})"));
  const auto pause = read_message(R"({"type":"pause","on":true})");
  ASSERT_TRUE(pause);
  EXPECT_TRUE(std::get<SetPause>(*pause).on);
  const auto record = read_message(R"({"type":"record","on":false})");
  ASSERT_TRUE(record);
  EXPECT_FALSE(std::get<SetRecording>(*record).on);
  const auto open = read_message(R"({"type":"open","scene":"touch-human"})");
  ASSERT_TRUE(open);
  EXPECT_EQ(std::get<OpenScene>(*open).scene, "touch-human");
  const auto set = read_message(R"({"type":"set","key":"tool.coupling.stiffness_n_m","value":250})");
  ASSERT_TRUE(set);
  EXPECT_EQ(std::get<SetValue>(*set).key, "tool.coupling.stiffness_n_m");
  EXPECT_EQ(std::get<SetValue>(*set).value, 250.0);
}

TEST(Messages, AHandleHasAUnitRotation) {
  const auto message = read_message(
      R"({"type":"handle","hand":0,"position":[0.1,-0.2,3e-1],"rotation":[0.9,0,0,0.9],"switches":3})");
  ASSERT_TRUE(message);
  const auto& move = std::get<MoveHandle>(*message);
  EXPECT_EQ(move.target.translation, Vec3(0.1, -0.2, 0.3));
  EXPECT_NEAR(move.target.rotation.norm(), 1.0, 1e-15);
  EXPECT_NEAR(move.target.rotation.w(), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(move.switches, 3U);
}

TEST(Messages, AnythingElseIsRejected) {
  const std::string pose = R"("position":[0,0,0],"rotation":[1,0,0,0])";
  int count = 0;
  for (const std::string& bad :
       std::initializer_list<std::string>{"",
                                          "take",
                                          "[]",
                                          "null",
                                          "{",
                                          R"({"type":"take"} x)",
                                          R"({"type":"fly"})",
                                          R"({"typ":"take"})",
                                          R"({"type":["take"]})",
                                          R"({"type":"take","hand":0})",
                                          R"({"type":"record"})",
                                          R"({"type":"record","on":1})",
                                          R"({"type":"open","scene":""})",
                                          R"({"type":"open","scene":7})",
                                          R"({"type":"open","scene":"a\u0000b"})",
                                          R"({"type":"set","key":"a","value":"1"})",
                                          R"({"type":"set","key":"a","value":1e999})",
                                          R"({"type":"set","key":"a"})",
                                          R"({"type":"handle","position":[0,0],"rotation":[1,0,0,0]})",
                                          R"({"type":"handle","position":[0,0,1e9],"rotation":[1,0,0,0]})",
                                          R"({"type":"handle","position":[0,0,null],"rotation":[1,0,0,0]})",
                                          R"({"type":"handle","position":[0,0,0],"rotation":[0,0,0,0]})",
                                          R"({"type":"handle","position":[0,0,0],"rotation":[9,0,0,0]})",
                                          R"({"type":"handle","position":[0,0,0]})",
                                          R"({"type":"handle","hand":-1,)" + pose + "}",
                                          R"({"type":"handle","hand":0.5,)" + pose + "}",
                                          R"({"type":"handle","switches":4294967296,)" + pose + "}",
                                          R"({"type":"handle","more":1,)" + pose + "}",
                                          "{\"type\":\"take\xff\"}",
                                          std::string(900, '[')}) {
    EXPECT_FALSE(read_message(bad)) << bad;
    ++count;
  }
  EXPECT_EQ(count, 30);
  EXPECT_TRUE(read_message(R"({"type":"handle",)" + pose + "}")) << "the rest is optional";
}

TEST(Messages, HaveALargestSize) {
  const std::string message = R"({"type":"take"})";
  EXPECT_TRUE(read_message(message + std::string(kLongestMessage - message.size(), ' ')));
  EXPECT_FALSE(read_message(message + std::string(kLongestMessage - message.size() + 1, ' ')));
}

}  // namespace
}  // namespace palpate::live
