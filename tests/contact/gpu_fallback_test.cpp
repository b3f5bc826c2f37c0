// Where the GPU cannot be had or is lost, the processor takes over, if the scene lets it.
#include "contact/depth_image.h"
#include "palpate/core/counters.h"
#include "palpate/core/error.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

std::unique_ptr<contact::DepthImage> none() { fail("no EGL device; install libegl1"); }

/// Answers as the processor does, until it is lost.
class Losing final : public contact::DepthImage {
 public:
  void answer(std::span<contact::DepthRequest* const> requests) override {
    if (++answers_ > 3) {  // in the middle of the second query
      for (contact::DepthRequest* request : requests) request->pairs.assign(1, {0, 0, 0});  // half-way
      fail("the GPU was reset");
    }
    image_->answer(requests);
  }

 private:
  int answers_ = 0;
  std::unique_ptr<contact::DepthImage> image_ = contact::make_cpu_image();
};
std::unique_ptr<contact::DepthImage> losing() { return std::make_unique<Losing>(); }

class GpuFallback : public ::testing::Test {
 protected:
  void SetUp() override { backend() = contact::DepthBackend::kGpu; }
  void TearDown() override { contact::gpu_image_maker() = before_; }

  /// Two pairs that ask together, after two queries on a way.
  std::unique_ptr<contact::ContactForce> after_two_queries(contact::ImageOptions options, bool whole_may) {
    TwoBalls balls;
    options.pixels = 64;
    options.candidate_gap = 0.02;
    options.quadrature_error = 1e-3;
    auto term = std::make_unique<contact::ContactForce>();
    term->add_pair(contact::make_image_source(balls.a.surface, balls.a.proxies, balls.b.surface,
                                              balls.b.proxies, options),
                   ContactSpec{});
    options.or_cpu = options.or_cpu && whole_may;
    term->add_pair(contact::make_image_source(balls.a.surface, balls.b.surface, options), ContactSpec{});
    for (const double rise : {0.0, 0.01}) {
      balls.state.q().segment(0, 3 * balls.nodes_of_a()).array() += rise;
      term->refresh(balls.state.view());
    }
    return term;
  }
  contact::ImageOptions options(contact::DepthBackend of, bool or_cpu) const {
    contact::ImageOptions out;
    out.backend = of;
    out.or_cpu = or_cpu;
    return out;
  }

 private:
  contact::MakeImage before_ = contact::gpu_image_maker();
};

}  // namespace

TEST_F(GpuFallback, TheProcessorGoesOnWithTheSameSamples) {
  const auto expected = after_two_queries(options(contact::DepthBackend::kCpu, false), true);
  ASSERT_GT(expected->samples().size(), 500u);
  EXPECT_TRUE(expected->fallbacks()[0].empty());
  for (const contact::MakeImage make : {none, losing}) {
    contact::gpu_image_maker() = make;
    const long before = counters::counter("contact.gpu_fallback").load();
    const auto term = after_two_queries(options(contact::DepthBackend::kGpu, true), true);
    EXPECT_EQ(counters::counter("contact.gpu_fallback").load(), before + 1);  // said once
    ASSERT_EQ(term->samples().size(), expected->samples().size());
    for (std::size_t i = 0; i < term->samples().size(); ++i) {
      ASSERT_EQ(term->samples()[i].gap, expected->samples()[i].gap) << i;
      ASSERT_EQ(term->samples()[i].source, expected->samples()[i].source) << i;
    }
    for (std::size_t pair = 0; pair < 2; ++pair) {
      EXPECT_EQ(term->methods()[pair], "cpu");
      EXPECT_NE(term->fallbacks()[pair].find(make == none ? "install libegl1" : "was reset"),
                std::string::npos)
          << term->fallbacks()[pair];
    }
  }
}

TEST_F(GpuFallback, NotWhereTheSceneNamesTheGpu) {
  for (const contact::MakeImage make : {none, losing}) {
    contact::gpu_image_maker() = make;
    EXPECT_THROW(after_two_queries(options(contact::DepthBackend::kGpu, false), true), Error);
    EXPECT_THROW(after_two_queries(options(contact::DepthBackend::kGpu, true), false), Error);
  }
}
