#include "live/http.h"

#include <gtest/gtest.h>

namespace palpate::live {
namespace {

TEST(Http, PagesOfTheSceneNeedTheToken) {
  const std::vector<SceneEntry> scenes = {{"press-ball", "A \"ball\".", ""}};
  for (const char* path : {"/", "/scenes", "/picture/press-ball.png"}) {
    EXPECT_EQ(reply_to(path, false, "t", scenes).status, 403U) << path;
    EXPECT_EQ(reply_to(path, false, "t", scenes).content().find("press-ball"), std::string_view::npos);
  }
  for (const char* path : {"/viewer.js", "/viewer.css", "/three.js"}) {
    EXPECT_EQ(reply_to(path, false, "t", scenes).status, 200U) << path;
    EXPECT_GT(reply_to(path, false, "t", scenes).content().size(), 500U) << path;
  }
  EXPECT_EQ(reply_to("/", true, "t", scenes).status, 200U);
  EXPECT_NE(reply_to("/", true, "t", scenes).content().find("viewer.js"), std::string_view::npos);
}

TEST(Http, OnlyPagesOfThisMachineMayFrameThePageAndOnlyOnRequest) {
  const auto policy = [](bool in_frames) {
    for (const HttpHeader& one : http_headers(in_frames))
      if (std::string_view(one.name) == "content-security-policy:") return one.value;
    return std::string();
  };
  const std::string alone = policy(false), framed = policy(true);
  EXPECT_TRUE(alone.ends_with("; frame-ancestors 'none'")) << alone;
  EXPECT_TRUE(framed.ends_with("; frame-ancestors http://127.0.0.1:* http://localhost:*")) << framed;
  EXPECT_EQ(alone.substr(0, alone.find("frame-ancestors")), framed.substr(0, framed.find("frame-ancestors")));
  EXPECT_TRUE(alone.starts_with("default-src 'none'; script-src 'self'; style-src 'self'; "));
  EXPECT_EQ(http_headers(false).size(), http_headers(true).size());
}

TEST(Http, TheListOfScenesIsJson) {
  const std::vector<SceneEntry> scenes = {{"a", "A \"ball\".", ""}, {"b", "", "/nowhere.png"}};
  EXPECT_EQ(reply_to("/scenes", true, "t", scenes).content(),
            R"([{"name":"a","picture":null,"summary":"A \"ball\"."},)"
            R"({"name":"b","picture":"/picture/b.png?token=t","summary":""}])");
  EXPECT_EQ(reply_to("/picture/b.png", true, "t", scenes).status, 404U) << "its file is not there";
}

TEST(Http, OnlyKnownPathsAreServed) {
  for (const char* path : {"/etc/passwd", "/../viewer.js", "/picture", "/socket", "", "//"})
    EXPECT_EQ(reply_to(path, true, "t", {}).status, 404U) << path;
  EXPECT_EQ(reply_to("/picture/../../etc/passwd", true, "t", {}).status, 404U);
}

}  // namespace
}  // namespace palpate::live
