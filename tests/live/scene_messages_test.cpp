#include "live/scene_messages.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "palpate/mesh/embedding.h"
#include "small_scene.h"

namespace palpate::live {
namespace {

using nlohmann::json;

TEST(SceneMessages, CountsAreThoseOfTheGeometry) {
  const scene::Description description = small_scene(
      {"obstacle=[{name=\"floor\",type=\"plane\",normal=[0.0,0.0,1.0],position_m=[0.0,0.0,-0.05]}]"});
  const auto world = loop::assemble(description);
  const std::vector<SceneSurface> obstacles = obstacle_surfaces(*world);
  const json message = json::parse(scene_message(*world, "small", sliders_of(description, {}), obstacles,
                                                 {std::make_shared<HandleMailbox>()}));
  EXPECT_EQ(message["type"], "scene");
  EXPECT_EQ(message["protocol"], 1);
  EXPECT_EQ(message["scene"], "small");
  EXPECT_EQ(message["scheme"], "partitioned");
  EXPECT_EQ(message["tick_s"], 1e-3);
  EXPECT_EQ(message["up"], json({0.0, 0.0, 1.0}));
  ASSERT_EQ(message["bodies"].size(), 1U);
  EXPECT_EQ(message["bodies"][0]["attached"], true);
  EXPECT_EQ(message["hands"][0]["live"], true);
  EXPECT_EQ(message["hands"][0]["max_force_n"], 3.3);
  EXPECT_EQ(message["sliders"].size(), 3U);
  std::size_t size = 8;
  for (const json& body : message["bodies"])
    size += 12 * body["nodes"].get<std::size_t>() + 16 * body["tets"].get<std::size_t>() +
            20 * body["vertices"].get<std::size_t>() + 12 * body["triangles"].get<std::size_t>();
  for (const char* kind : {"tools", "bones", "obstacles"})
    for (const json& surface : message[kind])
      size += 12 * (surface["vertices"].get<std::size_t>() + surface["triangles"].get<std::size_t>());
  const Bytes geometry = geometry_message(*world, obstacles);
  EXPECT_EQ(geometry.size(), size);
  const double top = message["bounds"]["max"][2];
  EXPECT_NEAR(top, 0.055, 1e-3) << "top of the tool";
}

TEST(SceneMessages, VerticesFollowFromNodesByTheirWeights) {
  const auto world = loop::assemble(small_scene());
  const loop::Body& body = world->bodies[0];
  const auto nodes = static_cast<std::size_t>(body.placed.cols());
  const auto tets = static_cast<std::size_t>(body.rest.tets.cols());
  const Points vertices = body.surface_points(body.placed);
  const auto count = static_cast<std::size_t>(vertices.cols());
  const Bytes bytes = geometry_message(*world, {});
  const auto number = [&]<class Number>(Number, std::size_t at) {
    Number out;
    std::memcpy(&out, bytes.data() + at, sizeof out);
    return out;
  };
  const std::size_t tets_at = 8 + 12 * nodes, tet_at = tets_at + 16 * tets, weights_at = tet_at + 4 * count;
  double largest = 0.0;
  for (std::size_t v = 0; v < count; ++v) {
    Vec3 sum = Vec3::Zero();
    const std::size_t tet = number(std::uint32_t{}, tet_at + 4 * v);
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t node = number(std::uint32_t{}, tets_at + 16 * tet + 4 * k);
      for (std::size_t i = 0; i < 3; ++i)
        sum[static_cast<int>(i)] += static_cast<double>(number(float{}, weights_at + 16 * v + 4 * k)) *
                                    static_cast<double>(number(float{}, 8 + 12 * node + 4 * i));
    }
    largest = std::max(largest, (sum - vertices.col(static_cast<Eigen::Index>(v))).norm());
  }
  EXPECT_GT(count, 10U);
  EXPECT_LT(largest, 1e-7) << "single precision of 3 cm";
}

}  // namespace
}  // namespace palpate::live
