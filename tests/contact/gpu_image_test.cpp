// What a query sends to the GPU, and that it sees there what the processor sees.
#include "contact/gpu_image.h"

#include <algorithm>
#include <map>

#include "contact/image_source.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

class GpuImages : public ::testing::Test {
 protected:
  void SetUp() override {
    backend() = contact::DepthBackend::kGpu;
    gpu_was_used() = true;
  }
};

std::vector<contact::ContactSample> samples_of(contact::SampleSource& source, const dynamics::State& state) {
  std::vector<contact::ContactSample> out;
  source.query(state.view(), out);
  return out;
}

/// How many samples of one list are not in the other, to the last bit of gap and area: a pixel that both see
/// has the same triangles, evaluated in double precision.
std::size_t differing(const std::vector<contact::ContactSample>& p,
                      const std::vector<contact::ContactSample>& q) {
  std::map<std::pair<double, double>, int> count;
  for (const auto& s : p) ++count[{s.gap, s.area}];
  for (const auto& s : q) --count[{s.gap, s.area}];
  std::size_t out = 0;
  for (const auto& [key, n] : count) out += static_cast<std::size_t>(std::abs(n));
  return out;
}

}  // namespace

/// Keeps what makes images, and the image that was made last.
class WatchedMaker {
 public:
  WatchedMaker() : before_(contact::gpu_image_maker()) {
    image() = nullptr;
    contact::gpu_image_maker() = [] {
      auto made = std::make_unique<contact::GpuImage>();
      image() = made.get();
      return std::unique_ptr<contact::DepthImage>(std::move(made));
    };
  }
  ~WatchedMaker() { contact::gpu_image_maker() = before_; }
  static contact::GpuImage*& image() {
    static contact::GpuImage* last = nullptr;
    return last;
  }

 private:
  contact::MakeImage before_;
};

// Skins never travel: a query sends the nodes of each soft body, once for all pairs and rounds, and a rigid
// surface is sent once for good.
TEST_F(GpuImages, AQuerySendsNodesAlone) {
  TwoBalls balls;
  const TriMesh tool = sphere(Vec3(-0.3, 0.6, 1.2), 0.5, 20);
  contact::ContactForce term;
  const auto frame = contact::fixed_frame();
  term.add_frame(frame);
  contact::ImageOptions options = balls.options();
  options.quadrature_error = 1e-3;
  term.add_pair(
      contact::make_image_source(balls.a.surface, balls.a.proxies, balls.b.surface, balls.b.proxies, options),
      ContactSpec{});
  term.add_pair(
      contact::make_image_source(balls.b.surface, balls.b.proxies, balls.a.surface, balls.a.proxies, options),
      ContactSpec{});
  auto last = contact::make_image_source(balls.a.surface, tool, 0, frame, options);
  term.add_pair(std::move(last), ContactSpec{});
  // the first pair's image answers all
  const WatchedMaker maker;
  term.refresh(balls.state.view());
  contact::GpuImage* const image = maker.image();
  ASSERT_TRUE(image);
  EXPECT_FALSE(contact::gpu_device().name.empty());
  EXPECT_NE(contact::gpu_device().driver.find("4."), std::string::npos);
  const auto bytes = [](Eigen::Index points) { return 16 * static_cast<std::size_t>(points); };
  const std::size_t nodes = bytes(balls.a.model.tets.nodes.cols() + balls.b.model.tets.nodes.cols()),
                    first = image->surfaces().sent_bytes();
  // once to prepare, once in the query; again where the tool made their buffer grow
  EXPECT_GE(first, 2 * nodes + bytes(tool.vertices.cols()));
  EXPECT_LE(first, 3 * nodes + bytes(tool.vertices.cols()));
  EXPECT_GE(term.stages()[0]->images, 2);  // more than one round
  term.refresh(balls.state.view());
  EXPECT_EQ(image->surfaces().sent_bytes() - first, nodes);
}

// What the first touch needs is made by the first query, in which nothing touches: the context, its programs,
// both surfaces.  Made at first touch it would be a hitch of a tenth of a second there.
TEST_F(GpuImages, FirstTouchFindsAllMade) {
  TwoBalls balls;
  const VecX touching = balls.state.q();
  const Eigen::Index of_a = 3 * balls.a.model.tets.nodes.cols();
  balls.state.q().head(of_a).array() += 10.0;
  contact::ContactForce term;
  term.add_pair(contact::make_image_source(balls.a.surface, balls.a.proxies, balls.b.surface, balls.b.proxies,
                                           balls.options()),
                ContactSpec{});
  const WatchedMaker maker;
  term.refresh(balls.state.view());
  contact::GpuImage* const image = maker.image();
  ASSERT_TRUE(image);
  EXPECT_EQ(term.stages()[0]->images, 0);
  EXPECT_EQ(image->surfaces().size(), 2u);
  const std::size_t sent = image->surfaces().sent_bytes();
  balls.state.q() = touching;
  term.refresh(balls.state.view());
  EXPECT_EQ(maker.image(), image);
  EXPECT_GT(term.stages()[0]->images, 0);
  EXPECT_EQ(image->surfaces().size(), 2u);
  EXPECT_EQ(image->surfaces().sent_bytes() - sent, 16 * static_cast<std::size_t>(balls.state.q().size() / 3));
}

// The same samples as by the processor but for pixels at the border of the overlap, wherever the bodies are:
// single precision counts from the body, not from the world's origin.  Where a first image aligns the normal,
// its border turns the normal a little, and with it all samples.
TEST_F(GpuImages, SeeWhatTheProcessorSees) {
  std::map<std::string, long> lines;  // pixels that single precision gave to the wrong triangle, among others
  for (const double away : {0.0, 1e5}) {
    SCOPED_TRACE(away);
    TwoBalls balls;
    balls.state.q().array() += away;
    const Pose pose{quaternion_of(Vec3(0.5, 1.1, -0.4)), Vec3(-0.2, 0.5, 1.1).array() + away};
    const TriMesh tool = sphere(Vec3(-0.1, 0.1, 0.1), 0.6, 20);
    const auto compare = [&](const char* what, bool aligned, auto make) {
      SCOPED_TRACE(what);
      contact::ImageOptions options = balls.options();
      options.backend = contact::DepthBackend::kCpu;
      const auto by_cpu = samples_of(*make(options), balls.state);
      options.backend = contact::DepthBackend::kGpu;
      const auto source = make(options);
      const auto by_gpu = samples_of(*source, balls.state), again = samples_of(*source, balls.state);
      ASSERT_GT(by_cpu.size(), 400u);
      const double count = static_cast<double>(by_cpu.size()), border = 4.0 * std::sqrt(count);
      if (!aligned) { EXPECT_LT(static_cast<double>(differing(by_cpu, by_gpu)), border); }
      EXPECT_NEAR(static_cast<double>(by_gpu.size()), count, border);
      if (away == 0.0) lines[what] = source->stages()->lines;
      EXPECT_NEAR(static_cast<double>(source->stages()->lines), static_cast<double>(lines[what]), border);
      EXPECT_EQ(by_gpu.size(), again.size());
      EXPECT_EQ(differing(by_gpu, again), 0u);
      const Total cpu = total(by_cpu, balls.state.view()), gpu = total(by_gpu, balls.state.view());
      EXPECT_LT((cpu.force - gpu.force).norm(), 1e-4 * cpu.force.norm());
    };
    compare("two skins, proxies", true, [&](const contact::ImageOptions& options) {
      return contact::make_image_source(balls.a.surface, balls.a.proxies, balls.b.surface, balls.b.proxies,
                                        options);
    });
    compare("two skins", false, [&](const contact::ImageOptions& options) {
      return contact::make_image_source(balls.a.surface, balls.b.surface, options);
    });
    compare("a tool", false, [&](const contact::ImageOptions& options) {
      return contact::make_image_source(balls.a.surface, tool, 0, contact::fixed_frame(pose), options);
    });
  }
}
