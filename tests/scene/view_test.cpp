#include "scene/view.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"

using namespace palpate;

namespace {

scene::ViewSpec parsed_view(const std::string& lines) {
  const std::string view = "[scene]\nname = \"s\"\nduration_s = 1.0\n[view]\n" + lines;
  const std::string body =
      "\n[[body]]\nname = \"b\"\nyoungs_modulus_pa = 1e4\nmesh = { generator = \"ball\", radius_m = 0.03, "
      "element_size_m = 0.01 }\n";
  return loop::parse(view + body, "s.toml").view;
}

std::string refused_view(const std::string& lines) {
  try {
    parsed_view(lines);
  } catch (const Error& e) { return e.what(); }
  return "";
}

}  // namespace

TEST(ViewDirection, HasNamesAndNumbers) {
  EXPECT_EQ(scene::view_direction("front"), Vec3(0, -1, 0));
  EXPECT_EQ(scene::view_direction("back"), Vec3(0, 1, 0));
  EXPECT_EQ(scene::view_direction("left"), Vec3(-1, 0, 0));
  EXPECT_EQ(scene::view_direction("right"), Vec3(1, 0, 0));
  EXPECT_EQ(scene::view_direction("top"), Vec3(0, 0, 1));
  EXPECT_EQ(scene::view_direction("bottom"), Vec3(0, 0, -1));
  EXPECT_EQ(scene::view_direction("1,-2,0.5"), Vec3(1, -2, 0.5));
  EXPECT_EQ(scene::view_direction(" 1e0 , 2 ,-3 "), Vec3(1, 2, -3));
  for (const char* bad :
       {"", "fornt", "Front", "1,2", "1,2,3,4", "1,2,", "0,0,0", "1,nan,0", "inf,0,0", "1 2 3"})
    EXPECT_FALSE(scene::view_direction(bad)) << bad;
}

TEST(ViewTable, IsReadInEveryForm) {
  const scene::ViewSpec none = parsed_view("");
  EXPECT_FALSE(none.direction);
  EXPECT_FALSE(none.target_m);
  EXPECT_EQ(none.zoom, 1.0);
  EXPECT_EQ(none.up, Vec3(0, 0, 1));
  EXPECT_EQ(parsed_view("direction = \"left\"").direction, Vec3(-1, 0, 0));
  EXPECT_EQ(parsed_view("direction = \"1,2,3\"").direction, Vec3(1, 2, 3));
  const scene::ViewSpec all =
      parsed_view("direction = [1, 0, 1]\ntarget_m = [0.1, 0, 0]\nzoom = 2\nup = [0, 1, 0]");
  EXPECT_EQ(all.direction, Vec3(1, 0, 1));
  EXPECT_EQ(all.target_m, Vec3(0.1, 0, 0));
  EXPECT_EQ(all.zoom, 2.0);
  EXPECT_EQ(all.up, Vec3(0, 1, 0));
}

TEST(ViewTable, RefusesWithPlaceValueAndRemedy) {
  EXPECT_NE(refused_view("direction = \"fornt\"")
                .find("s.toml:5:13: view: direction = \"fornt\" must be \"front\""),
            std::string::npos)
      << refused_view("direction = \"fornt\"");
  EXPECT_NE(refused_view("direction = \"fornt\"").find("did you mean \"front\""), std::string::npos);
  EXPECT_NE(refused_view("direction = [0, 0, 0]").find("must not be zero"), std::string::npos);
  EXPECT_NE(refused_view("up = [0, 0, 0]").find("must not be zero"), std::string::npos);
  EXPECT_NE(refused_view("zoom = 0").find("zoom"), std::string::npos);
  EXPECT_NE(refused_view("direktion = \"front\"").find("did you mean \"direction\""), std::string::npos);
}
