#include <algorithm>
#include <cstring>
#include <limits>

#include "fem_fixture.h"
#include "palpate/core/workers.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

constexpr double kOthers = 7.0;

/// A body of several chunks after a block of three other nodes, in a matrix that also has pairs without a
/// common element.
struct Scene {
  TetMesh rest = jittered_cube(9, 0.15, 31);  // 4,374 elements in several chunks
  dynamics::State state;
  int others = 0, id = 0;
  dynamics::BorderedMatrix A;
  SoftBody body;

  explicit Scene(const SoftBodyOptions& options)
      : others(insert("others", VecX::Zero(9))),
        id(insert("body", shaken())),
        body("b", rest, material(), options, id) {
    dynamics::PatternBuilder builder(state.layout());
    body.add_pattern(builder);
    const int last = state.layout().node_count() - 1;
    builder.add_pair(0, 3);
    builder.add_pair(2, last);
    builder.add_pair(3, last);
    builder.add_pair(100, 700);
    A.body = builder.build();
  }

  int insert(const std::string& name, const VecX& x) {
    const int size = static_cast<int>(x.size());
    return state.insert(dynamics::BlockSpec{.name = name, .q_size = size, .u_size = size}, x,
                        Random(33).vector(size));
  }
  VecX shaken() const {
    Random random(32);
    return flat(random.rotation() * rest.nodes) + 0.02 * random.vector(3 * rest.nodes.cols());
  }
  static Material material() {
    Material m = soft_material();
    m.stiffness_damping = 0.4;
    m.mass_damping = 0.3;
    return m;
  }
  /// Index at which the body's rows begin.
  std::size_t own_values() const { return 9 * static_cast<std::size_t>(A.body.row_start()[3]); }

  std::vector<double> added(double k_scale, double d_scale) {
    A.set_zero();
    body.add_tangent(state.view(), k_scale, d_scale, A);
    return A.body.values();
  }
  std::vector<double> stored(double k_scale, double d_scale) {
    std::vector<double>& values = A.body.values();
    const auto own = values.begin() + static_cast<std::ptrdiff_t>(own_values());
    std::fill(values.begin(), own, kOthers);
    std::fill(own, values.end(), std::numeric_limits<double>::quiet_NaN());
    body.store_tangent(state.view(), k_scale, d_scale, A);
    return values;
  }
  void expect_same(double k_scale, double d_scale) {
    const std::vector<double> expected = added(k_scale, d_scale), found = stored(k_scale, d_scale);
    std::size_t touched = 0, different = 0;
    for (std::size_t i = 0; i < own_values(); ++i) touched += found[i] != kOthers;
    for (std::size_t i = own_values(); i < found.size(); ++i) different += found[i] != expected[i];
    EXPECT_EQ(touched, 0u) << "rows of another block were touched";
    EXPECT_EQ(different, 0u) << "of " << found.size() - own_values();
    EXPECT_EQ(*std::max_element(expected.begin(), expected.end()) > 0.0, k_scale != 0.0 || d_scale != 0.0);
  }
};

}  // namespace

TEST(StoredTangent, IsTheAddedOneWhateverStoodThere) {
  for (const char* instructions : {"baseline", "avx2", "avx512"}) {
    if (!message_of([&] {
           SoftBody("b", one_tet(), soft_material(), {.instructions = instructions}, 0);
         }).empty())
      continue;
    for (const bool full : {false, true}) {
      Scene scene({.tangent = Tangent::kExact, .full_damping_tangent = full, .instructions = instructions});
      for (const int threads : {1, 2}) {
        SCOPED_TRACE(std::string(instructions) + (full ? ", unsymmetric, threads: " : ", threads: ") +
                     std::to_string(threads));
        workers::set_count(threads);
        scene.expect_same(0.7, 1.9);
        scene.expect_same(0.7, 0.0);
        scene.expect_same(0.0, 1.9);
        scene.expect_same(0.0, 0.0);
        workers::set_count(1);
      }
    }
  }
}

TEST(StoredTangent, FollowsThePattern) {
  Scene scene({.tangent = Tangent::kWarped});
  scene.expect_same(1.0, 0.1);
  dynamics::PatternBuilder builder(scene.state.layout());
  scene.body.add_pattern(builder);
  builder.add_pair(50, 900);
  scene.A.body = builder.build();
  scene.expect_same(1.0, 0.1);
}

TEST(StoredTangent, ThreadsChangeNoBit) {
  Scene scene({.tangent = Tangent::kExact, .full_damping_tangent = true});
  const std::vector<double> one = scene.stored(0.7, 1.9);
  workers::set_count(2);
  const std::vector<double> two = scene.stored(0.7, 1.9);
  workers::set_count(1);
  EXPECT_EQ(std::memcmp(one.data(), two.data(), sizeof(double) * one.size()), 0);
}
